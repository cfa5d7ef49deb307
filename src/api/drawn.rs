//! Pictures and reports of jobs, drawn on the first request and cached in memory like those of checks.

use std::collections::BTreeMap;

use axum::http::{HeaderMap, header};
use axum::response::IntoResponse;
use bytes::Bytes;
use tokio::runtime::Handle;

use super::accepted::checked_in_time;
use super::error::{ApiError, ApiResult};
use super::parameters::no_such_job;
use super::report::stored_report;
use super::{Service, conditional, middleware};
use crate::jobs::{Finished, JobInput};
use crate::schema::predict::output::PictureName;
use crate::schema::wire::problem::Problem;
use crate::schema::{ErrorCode, Language};
use crate::store::JobRow;
use mechanics::mesh::ignored::listed;

/// The requested picture or report, and its language.
#[derive(Clone, Copy)]
struct DrawingRequest {
    picture: PictureName,
    language: Language,
}

impl DrawingRequest {
    /// Its key in the cache; pictures have one language.
    fn cache_key(self) -> String {
        let name = self.picture.output().file_name();
        match PictureName::REPORTS.contains(&self.picture) {
            true => format!("{name} {}", self.language.tag()),
            false => name.to_owned(),
        }
    }
}

/// A picture or report of a job that is none of its files, in the requested language, else in one that the client
/// prefers.
pub async fn picture(
    service: &Service,
    job: &JobRow,
    name: &str,
    language: Option<Language>,
    headers: &HeaderMap,
) -> ApiResult {
    let named = |picture: &PictureName| picture.output().file_name() == name;
    let Some(picture) = PictureName::ALL.into_iter().find(named) else {
        return Err(no_such_output(job, name));
    };
    let media_type = picture.output().media_type();
    middleware::check_accept(headers, media_type.split(';').next().unwrap_or_default())?;
    let liked = headers.get(header::ACCEPT_LANGUAGE).and_then(|value| value.to_str().ok());
    let language = language.unwrap_or_else(|| Language::accepted(liked.unwrap_or_default()));
    let wanted = DrawingRequest { picture, language };
    let bytes = match service.pictures.get(&job.id, &wanted.cache_key()) {
        Some(bytes) => bytes,
        None => drawn(service, job, wanted).await?,
    };
    // A report is for reading; pictures, which may hold scripts where a client made their texts, are not opened by browsers.
    let shown = if media_type.starts_with("text/html") { "inline" } else { "attachment" };
    let disposition = format!("{shown}; filename=\"{name}\"");
    let told = [
        (header::CONTENT_TYPE, media_type),
        (header::CACHE_CONTROL, "private, no-cache"),
        (header::CONTENT_DISPOSITION, &disposition),
        (header::VARY, "Accept-Language"),
    ];
    conditional::document(headers, (told, bytes).into_response()).await
}

async fn drawn(service: &Service, job: &JobRow, wanted: DrawingRequest) -> ApiResult<Bytes> {
    let DrawingRequest { picture, language } = wanted;
    let name = picture.output().file_name();
    let finished = finished(service, job).await?.filter(|finished| finished.has(picture));
    let finished = finished.ok_or_else(|| no_such_output(job, name))?;
    if finished.has_skin()
        && let Some(source) = picture.drawn_from().map(|source| source.file_name())
        && service.store.job_file(&job.id, source).await?.is_none()
    {
        let detail = format!(
            "{name} is drawn from {source}, which the job did not write: state it in `outputs` of the spec and post the job again"
        );
        return Err(ApiError::new(ErrorCode::NoSuchOutput, detail));
    }
    let sources = service.library.source(Handle::current(), BTreeMap::new());
    let drawn = checked_in_time(service, move |limits, stop| {
        finished.draw((picture, language), &sources, limits, stop)
    });
    let bytes = Bytes::from(drawn.await?);
    let (case, cache_key) = (job.case_id.as_deref(), wanted.cache_key());
    service.pictures.keep_job_picture(&job.id, case, &cache_key, bytes.clone());
    // If it was erased meanwhile, the picture was not in the cache yet.
    if service.store.job_status(&job.id).await?.is_none() {
        service.pictures.forget(&job.id);
        return Err(no_such_job());
    }
    Ok(bytes)
}

/// The result of the job, if it can be drawn.
async fn finished(service: &Service, job: &JobRow) -> ApiResult<Option<Finished>> {
    let document = service.store.job_document(&job.id).await?.ok_or_else(no_such_job)?;
    let input: JobInput = serde_json::from_str(&document)
        .map_err(ApiError::unreadable("the input of job", &job.id))?;
    let result = job.result.as_deref().unwrap_or("null");
    let result =
        serde_json::from_str(result).map_err(ApiError::unreadable("the result of job", &job.id))?;
    let study = stored_report(service, &job.id).await?.map(|(_, report)| report);
    Ok(Finished::of_job(&job.id, input, result, study))
}

/// With the available files, and how to get more.
fn no_such_output(job: &JobRow, name: &str) -> ApiError {
    let result = job.result.as_deref().unwrap_or("null");
    let result: serde_json::Value = serde_json::from_str(result).unwrap_or_default();
    let names = |list: &str| -> Vec<String> {
        let entries = result.get(list).and_then(|entries| entries.as_array()).into_iter().flatten();
        let named = entries.filter_map(|entry| entry.get("name").unwrap_or(entry).as_str());
        named.map(str::to_owned).collect()
    };
    let there: Vec<String> = names("files").into_iter().chain(names("pictures")).collect();
    let detail = format!(
        "the job has no file {name:?}; it has: {}. Others are written where `outputs` of the spec names them",
        listed(there.iter())
    );
    let problem = Problem::new(ErrorCode::NoSuchOutput, detail);
    problem.with("files", there).into()
}
