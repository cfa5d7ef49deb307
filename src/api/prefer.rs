//! `Prefer: wait=n` (RFC 7240): the wait of a client for the end of a job.

use std::time::Duration;

use axum::http::{HeaderMap, HeaderName};
use axum::response::Response;
use tokio::time::Instant;

use super::error::ApiResult;
use super::parameters::no_such_job;
use super::{Service, with_header};
use crate::schema::ErrorCode;
use crate::schema::job::JobStatus;
use crate::schema::wire::problem::Problem;
use crate::store::JobRow;

/// Interval of queries without notifications: another process may have changed rows.
const LOOK: Duration = Duration::from_secs(1);

/// The advised delay before a client retries.
pub const RETRY_AFTER_S: u32 = 1;

/// The requested seconds, at most `cap`; `None` if absent or invalid.
pub fn requested_wait(headers: &HeaderMap, cap: u32) -> Option<u32> {
    headers
        .get_all("prefer")
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split([',', ';']))
        .filter_map(|preference| preference.split_once('='))
        .find(|(name, _)| name.trim().eq_ignore_ascii_case("wait"))
        .and_then(|(_, seconds)| seconds.trim().trim_matches('"').parse::<u64>().ok())
        .map(|seconds| u32::try_from(seconds).unwrap_or(u32::MAX).min(cap))
}

/// Adds the header of the granted wait.
pub fn with_wait(answer: Response, wait: Option<u32>) -> Response {
    let Some(wait) = wait else { return answer };
    with_header(answer, HeaderName::from_static("preference-applied"), &format!("wait={wait}"))
}

/// Waits until a job has ended or is gone, the time is up, the client has left or the process is about to stop, and returns
/// its state then.
pub async fn wait_for_end(service: &Service, id: &str, seconds: u32) -> ApiResult<Option<JobRow>> {
    let store = &service.store;
    let mut stopping = service.streams.stopping();
    let until = Instant::now() + Duration::from_secs(seconds.into());
    let mut changes = store.job_changes();
    let mut has_left = false;
    loop {
        changes.mark_seen();
        let over = has_left || Instant::now() >= until || *stopping.borrow();
        // Only after the wait is the whole row read.
        if over || store.job_status(id).await?.is_none_or(JobStatus::is_terminal) {
            return Ok(store.job(id).await?);
        }
        let next = until.min(Instant::now() + LOOK);
        // Time that runs out is no error: the row is looked at again.
        tokio::select! {
            changed = tokio::time::timeout_at(next, changes.of(id)) => changed.unwrap_or(Ok(()))?,
            _ = stopping.wait_for(|stopping| *stopping) => {}
            () = service.client_disconnected() => has_left = true,
        }
    }
}

/// The job, if it has results; waits for them on a client's preference.
pub(super) async fn successful(
    service: &Service,
    id: &str,
    headers: &HeaderMap,
) -> ApiResult<JobRow> {
    let wait = requested_wait(headers, service.limits.wait_s).unwrap_or(0);
    let job = wait_for_end(service, id, wait).await?.ok_or_else(no_such_job)?;
    match job.status {
        JobStatus::Successful => Ok(job),
        JobStatus::Failed | JobStatus::Dismissed => {
            let error = job.error.as_deref().unwrap_or("null");
            let error: serde_json::Value = serde_json::from_str(error).unwrap_or_default();
            let detail = format!("the job is {} and has no results", job.status.name());
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wait_is_capped_and_nonsense_is_no_wait() {
        let wait = |value: &str| {
            let mut headers = HeaderMap::new();
            headers.insert("prefer", value.parse().unwrap());
            requested_wait(&headers, 30)
        };
        assert_eq!(wait("wait=5"), Some(5));
        assert_eq!(wait("respond-async, wait=7"), Some(7));
        assert_eq!(wait("WAIT=\"3\""), Some(3));
        assert_eq!(wait("wait=99999"), Some(30));
        assert_eq!(wait("wait=99999999999999"), Some(30));
        assert_eq!(wait("wait=-1"), None);
        assert_eq!(wait("respond-async"), None);
        assert_eq!(requested_wait(&HeaderMap::new(), 30), None);
    }
}
