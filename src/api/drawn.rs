//! Pictures of predictions, drawn when they are first asked for and kept in memory like those of checks.

use std::collections::BTreeMap;

use axum::http::{HeaderMap, header};
use axum::response::IntoResponse;
use bytes::Bytes;
use tokio::runtime::Handle;

use super::error::{ApiError, ApiResult};
use super::parameters::no_such_job;
use super::{Service, accepted, conditional, guard};
use crate::jobs::{Finished, JobInput};
use crate::schema::predict::output::PictureName;
use crate::schema::{ErrorCode, Limits};
use crate::store::JobRow;

/// A picture of a job that is none of its files.
pub async fn picture(
    service: &Service,
    job: &JobRow,
    name: &str,
    headers: &HeaderMap,
) -> ApiResult {
    let named = |picture: &PictureName| picture.output().file_name() == name;
    let picture = PictureName::ALL.into_iter().find(named).ok_or_else(no_such_output)?;
    let media_type = picture.output().media_type();
    guard::check_accept(headers, media_type)?;
    let svg = match service.pictures.get(&job.id, name) {
        Some(svg) => svg,
        None => drawn(service, job, picture).await?,
    };
    let disposition = format!("attachment; filename=\"{name}\"");
    let told = [
        (header::CONTENT_TYPE, media_type),
        (header::CACHE_CONTROL, "private, no-cache"),
        (header::CONTENT_DISPOSITION, &disposition),
    ];
    conditional::document(headers, (told, svg).into_response()).await
}

async fn drawn(service: &Service, job: &JobRow, picture: PictureName) -> ApiResult<Bytes> {
    let finished = finished(service, job).await?.ok_or_else(no_such_output)?;
    let name = picture.output().file_name();
    if let Some(source) = picture.drawn_from().map(|source| source.file_name())
        && service.store.job_file(&job.id, source).await?.is_none()
    {
        let detail = format!("{name} is drawn from {source}, which the job did not write");
        return Err(ApiError::new(ErrorCode::NoSuchOutput, detail));
    }
    let sources = service.library.source(Handle::current(), BTreeMap::new());
    let limits: Limits = (*service.limits).clone();
    let turn = service.check_turn().await?;
    let svg = turn.compute(move || finished.draw(picture, &sources, &limits)).await?;
    let svg = Bytes::from(svg.map_err(accepted::refusal)?);
    service.pictures.keep_of_job(&job.id, job.case_id.as_deref(), name, svg.clone());
    // Whoever erased it meanwhile found nothing to give up.
    if service.store.job_status(&job.id).await?.is_none() {
        service.pictures.forget(&job.id);
        return Err(no_such_job());
    }
    Ok(svg)
}

/// What the job predicted, if it did.
async fn finished(service: &Service, job: &JobRow) -> ApiResult<Option<Finished>> {
    let document = service.store.job_document(&job.id).await?.ok_or_else(no_such_job)?;
    let input: JobInput = serde_json::from_str(&document).map_err(ApiError::internal)?;
    let result = job.result.as_deref().unwrap_or("null");
    let result = serde_json::from_str(result).map_err(ApiError::internal)?;
    Ok(Finished::of_job(&job.id, input, result))
}

fn no_such_output() -> ApiError {
    ApiError::new(ErrorCode::NoSuchOutput, "the job has no file of this name")
}
