//! Results: the manifest of a job and its files.

use axum::http::{HeaderMap, StatusCode};
use utoipa_axum::routes;

use super::download::Opened;
use super::error::{ApiError, ApiResult};
use super::parameters::{FileName, Id, no_such_job};
use super::prefer::{wait_for_end, wanted_wait};
use super::resources::Resources;
use super::{Service, conditional, guard, json};
use crate::schema::ErrorCode;
use crate::schema::job::JobStatus;
use crate::schema::key::Scope;
use crate::schema::predict::result::ResultDocument;
use crate::schema::wire::problem::Problem;
use crate::store::JobRow;

/// How long a client had better wait before it asks again.
pub const RETRY_AFTER_S: u32 = 1;

pub fn router() -> Resources {
    let manifest = Resources::new().looks(Scope::Read, routes!(manifest)).json_only();
    manifest.looks(Scope::Read, routes!(file))
}

/// The job, when it has results; a client that prefers to wait for them does so.
pub(super) async fn successful(
    service: &Service,
    id: &str,
    headers: &HeaderMap,
) -> ApiResult<JobRow> {
    let wait = wanted_wait(headers, service.limits.wait_s).unwrap_or(0);
    let job = wait_for_end(service, id, wait).await?.ok_or_else(no_such_job)?;
    match job.status {
        JobStatus::Successful => Ok(job),
        JobStatus::Failed | JobStatus::Dismissed => {
            let error = job.error.as_deref().unwrap_or("null");
            let error: serde_json::Value = serde_json::from_str(error).unwrap_or_default();
            let detail = format!("the job has {} and has no results", job.status.name());
            Err(Problem::new(ErrorCode::JobFailed, detail)
                .with("job_status", job.status.name())
                .with("error", error)
                .into())
        }
        JobStatus::Accepted | JobStatus::Running => {
            let detail = format!(
                "the job is {} and has no results yet; the header `Prefer: wait=n` waits up to n seconds, at most {}",
                job.status.name(),
                service.limits.wait_s
            );
            Err(Problem::new(ErrorCode::ResultNotReady, detail)
                .with("job_status", job.status.name())
                .with("progress", job.progress)
                .with("retry_after_s", RETRY_AFTER_S)
                .into())
        }
    }
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
    let result: serde_json::Value = serde_json::from_str(result).map_err(ApiError::internal)?;
    conditional::document(&headers, json(StatusCode::OK, &result)).await
}

/// One file of the results.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/{file}", operation_id = "download_result", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("file" = String, Path, description = "its name in the manifest, e.g. skin.vtp"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
    ),
    responses(
        (status = 200, description = "the file, of the media type that the manifest says", content((Vec<u8> = "*/*"))),
        (status = 206, description = "the range that was asked for", content((Vec<u8> = "*/*"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such job or file, or the job has not ended"),
        (status = 416, description = "the range is outside the file"),
        (status = 422, description = "the job failed or was dismissed"),
    )
)]
async fn file(service: Service, FileName { job, name }: FileName, headers: HeaderMap) -> ApiResult {
    successful(&service, &job, &headers).await?;
    let row = service.store.job_file(&job, &name).await?;
    let row = row.ok_or_else(|| {
        ApiError::new(ErrorCode::NoSuchOutput, "the job has no file of this name")
    })?;
    guard::check_accept(&headers, row.media_type.split(';').next().unwrap_or_default())?;
    if conditional::is_known(&headers, &row.blob) {
        return Ok(conditional::not_modified(&row.blob));
    }
    let file = Opened::blob(&service, &row.blob).await?;
    conditional::file(&headers, file, (&row.media_type, &row.name), &row.blob)
}
