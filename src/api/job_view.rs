//! Status document of a job (statusInfo) from its row of the queue.

use super::error::{ApiError, ApiResult};
use super::time;
use crate::schema::job::{JobStatus, StatusInfo};
use crate::schema::job_document::JobKind;
use crate::schema::link::Link;
use crate::schema::predict::result::ResultDocument;
use crate::store::JobRow;

pub fn status_info(row: &JobRow, deduplicated: bool) -> ApiResult<StatusInfo> {
    let kind = JobKind::from_name(&row.kind)
        .ok_or_else(|| ApiError::internal(format!("job {} is of kind `{}`", row.id, row.kind)))?;
    let results: Option<ResultDocument> = parsed(row, row.result.as_deref())?;
    let warnings = results.as_ref().map(|results| results.warnings.clone());
    let is_running = row.status == JobStatus::Running;
    Ok(StatusInfo {
        id: row.id.clone(),
        kind,
        status: row.status,
        phase: row.phase.clone().filter(|_| is_running),
        message: message(row),
        progress: u8::try_from(row.progress.clamp(0, 100)).unwrap_or(100),
        // Where work stands says nothing of what it came to.
        iteration: row
            .iteration
            .filter(|_| is_running)
            .and_then(|iteration| u64::try_from(iteration).ok()),
        residual: row.residual.filter(|_| is_running),
        created: time::rfc3339(row.created),
        started: row.started.map(time::rfc3339),
        finished: row.finished.map(time::rfc3339),
        updated: time::rfc3339(row.updated),
        attempt: u32::try_from(row.attempt).unwrap_or(u32::MAX),
        queue_position: row.queue_position.and_then(|position| u64::try_from(position).ok()),
        spec_hash: row.spec_hash.clone(),
        engine: serde_json::from_str(&row.engine).map_err(ApiError::unreadable("job", &row.id))?,
        case: row.case_id.clone(),
        tags: row.tags.clone(),
        deduplicated,
        truths: parsed(row, row.truths.as_deref())?.unwrap_or_default(),
        error: parsed(row, row.error.as_deref())?,
        warnings: warnings.unwrap_or_default(),
        links: links(row, results.as_ref()),
        results,
    })
}

fn parsed<T: serde::de::DeserializeOwned>(
    row: &JobRow,
    text: Option<&str>,
) -> ApiResult<Option<T>> {
    text.map(serde_json::from_str).transpose().map_err(ApiError::unreadable("job", &row.id))
}

fn message(row: &JobRow) -> String {
    match (row.status, &row.phase) {
        (JobStatus::Accepted, _) if row.attempt > 0 => {
            format!("waits for a worker after attempt {}", row.attempt)
        }
        (JobStatus::Accepted, _) => match &row.waits_for {
            Some(meshing) => format!("waits for the mesh of its case, which job {meshing} makes"),
            None => "waits for a worker".to_owned(),
        },
        (JobStatus::Running, Some(phase)) => format!("attempt {}: {phase}", row.attempt),
        (JobStatus::Running, None) => format!("attempt {} has started", row.attempt),
        (JobStatus::Successful, _) => "the results are available".to_owned(),
        (JobStatus::Failed, _) => "failed; `error` says why".to_owned(),
        (JobStatus::Dismissed, _) => "dismissed on request".to_owned(),
    }
}

fn links(row: &JobRow, found: Option<&ResultDocument>) -> Vec<Link> {
    let link = |href: String, rel: &str| Link {
        href,
        rel: rel.to_owned(),
        media_type: "application/json".to_owned(),
    };
    let own = format!("/v1/jobs/{}", row.id);
    let results = format!("{own}/results");
    let mut links = vec![link(own, "self")];
    if row.status == JobStatus::Successful
        && JobKind::from_name(&row.kind).is_some_and(JobKind::has_report)
    {
        links.push(link(format!("/v1/jobs/{}/report", row.id), "describedby"));
    }
    if row.status == JobStatus::Successful {
        links.push(link(results, "http://www.opengis.net/def/rel/ogc/1.0/results"));
    }
    links.extend(found.into_iter().flat_map(|found| &found.kept).map(|kept| kept.link.clone()));
    links
}
