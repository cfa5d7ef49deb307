//! Results: the manifest of a job and its files.

use axum::http::{HeaderMap, StatusCode};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::routes;

use super::download::ServedFile;
use super::error::{ApiError, ApiResult};
use super::parameters::{FileName, Id, Parameters};
use super::prefer::successful;
use super::resources::Resources;
use super::{Service, conditional, drawn, json, middleware};
use crate::schema::Language;
use crate::schema::key::Scope;
use crate::schema::predict::result::ResultDocument;

pub fn router() -> Resources {
    let manifest = Resources::new().reads(Scope::Read, routes!(manifest)).json_only();
    manifest.reads(Scope::Read, routes!(file))
}

/// The manifest: files with their hashes, statistics, provenance.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results", operation_id = "show_results", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
    ),
    responses(
        (status = 200, description = "the manifest", body = ResultDocument, headers(("ETag" = String, description = "its hash"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such job, or it has not ended"),
        (status = 422, description = "the job failed or was dismissed"),
    )
)]
async fn manifest(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let job = successful(&service, &id, &headers).await?;
    let result = job.result.as_deref().unwrap_or("null");
    let result: serde_json::Value =
        serde_json::from_str(result).map_err(ApiError::unreadable("the result of job", &id))?;
    conditional::document(&headers, json(StatusCode::OK, &result)).await
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct FileParameters {
    /// The language of a drawn report. Default: the preferred one of the header Accept-Language, else `en`.
    #[param(inline)]
    lang: Option<Language>,
}

/// One file of the results, or a picture or report, which is drawn when first requested.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/{file}", operation_id = "download_result", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("file" = String, Path, description = "its name in the manifest, e.g. skin.vtp or report.html"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
        FileParameters
    ),
    responses(
        (status = 200, description = "the file, with the media type in the manifest", content((Vec<u8> = "*/*"))),
        (status = 206, description = "the requested range of a file; a picture or report that is drawn is sent whole", content((Vec<u8> = "*/*"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such job or file, or the job has not ended"),
        (status = 416, description = "the range is outside the file"),
        (status = 422, description = "the job failed or was dismissed"),
    )
)]
async fn file(
    service: Service,
    FileName { job, name }: FileName,
    Parameters(FileParameters { lang }): Parameters<FileParameters>,
    headers: HeaderMap,
) -> ApiResult {
    let found = successful(&service, &job, &headers).await?;
    let Some(row) = service.store.job_file(&job, &name).await? else {
        return drawn::picture(&service, &found, &name, lang, &headers).await;
    };
    middleware::check_accept(&headers, row.media_type.split(';').next().unwrap_or_default())?;
    if conditional::is_known(&headers, &row.blob) {
        return Ok(conditional::not_modified(&row.blob));
    }
    let file = ServedFile::blob(&service, &row.blob).await;
    let file = file.map_err(|error| error.of_bytes(format_args!("{name} of job {job}")))?;
    conditional::file(&headers, file, (&row.media_type, &row.name), &row.blob)
}
