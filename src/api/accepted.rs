//! Acceptance of a job: its input is checked with its meshes and queued.

use std::collections::BTreeMap;
use std::time::Duration;

use tokio::runtime::Handle;

use super::Service;
use super::error::{ApiError, ApiResult};
use super::meshes::document_of;
use super::parameters::id;
use crate::jobs::{JobError, JobInput, MeshSource, SourceError};
use crate::schema::job::JobStatus;
use crate::schema::predict::result::EngineDocument;
use crate::schema::study::expected::TruthCostDocument;
use crate::schema::{ErrorCode, Faults, Limits, Pointer, PredictDocument, Problem};
use crate::store::{JobRow, NewJob};
use mechanics::progress::StopQuery;

/// The most waiting jobs.
pub(super) const LONGEST_QUEUE: i64 = 10_000;

/// The refusal of one more.
pub(super) fn queue_full() -> ApiError {
    ApiError::new(ErrorCode::QueueFull, format!("{LONGEST_QUEUE} jobs are waiting"))
}

/// Checks a job with its meshes, off the async threads; returns it with the findings of `prepare`.
pub(super) async fn prepared<I: Send + 'static, T: Send + 'static>(
    service: &Service,
    input: I,
    prepare: fn(&I, &dyn MeshSource, &Limits, &StopQuery) -> Result<T, JobError>,
) -> ApiResult<(I, T)> {
    let sources = service.library.source(Handle::current(), BTreeMap::new());
    let found = checked_in_time(service, move |limits, stop| {
        let found = prepare(&input, &sources, limits, stop)?;
        Ok((input, found))
    });
    found.await.map_err(|error| error.map_problem(in_spec))
}

/// What a check finds, with the permit of its request and off the async threads. It ends with its client, and is refused when it takes
/// longer than `check_s` of the limits.
pub(super) async fn checked_in_time<T: Send + 'static>(
    service: &Service,
    check: impl FnOnce(&Limits, &StopQuery) -> Result<T, JobError> + Send + 'static,
) -> ApiResult<T> {
    let limits = service.limits.clone();
    let check_s = limits.check_s;
    let longest = Duration::try_from_secs_f64(check_s).unwrap_or(Duration::MAX);
    let permit = service.check_permit().await?;
    let found =
        permit.compute_within(longest, move |watch| check(&limits, &StopQuery::of(watch))).await?;
    found.map_err(|error| match error {
        JobError::Cancelled => too_long(check_s),
        other => refusal(other),
    })
}

/// The refusal of a check that would hold its permit too long: the same again takes as long.
fn too_long(check_s: f64) -> ApiError {
    let detail = format!(
        "the check took more than {check_s} s, which `check_s` of /v1/limits allows, and was given up: the mesh, its surfaces, muscles or \
         image, or the scenes of a study, are too many for one request"
    );
    let problem = Problem::new(ErrorCode::BudgetExceeded, detail);
    problem.with("which", "check").with("allowed_s", check_s).into()
}

/// A job named by a document, which has to be successful.
pub(super) async fn successful_job(service: &Service, at: &str, job: &str) -> ApiResult<JobRow> {
    let row = match id(job) {
        Some(id) => service.store.job(&id).await?,
        None => None,
    };
    let row = row.ok_or_else(|| fault(at, ErrorCode::UnknownJob, "there is no such job"))?;
    if row.status != JobStatus::Successful {
        let detail = format!("the job is {}, and has to be successful", row.status.name());
        return Err(fault(at, ErrorCode::ResultNotReady, &detail));
    }
    Ok(row)
}

/// Data of an accepted job beside its document.
pub(super) struct Accepted {
    pub case_id: Option<String>,
    pub shared_cases: Vec<String>,
    pub spec_hash: String,
    pub tags: Vec<String>,
    pub mesh_ids: Vec<String>,
    pub study: Option<AcceptedStudy>,
}

/// Further data of a study: the key of its rows, and the expected cost of its reference solutions.
pub(super) struct AcceptedStudy {
    pub rows_key: String,
    pub truths: Vec<TruthCostDocument>,
}

impl Accepted {
    pub fn with(self, input: &JobInput) -> ApiResult<NewJob> {
        let engine = serde_json::to_string(&EngineDocument::this()).map_err(ApiError::internal)?;
        let truths = self.study.as_ref().map(|study| serde_json::to_string(&study.truths));
        Ok(NewJob {
            truths: truths.transpose().map_err(ApiError::internal)?,
            rows_key: self.study.map(|study| study.rows_key),
            id: uuid::Uuid::now_v7().to_string(),
            kind: input.kind().name(),
            priority: input.kind().priority(),
            case_id: self.case_id,
            shared_cases: self.shared_cases,
            document: serde_json::to_string(input).map_err(ApiError::internal)?,
            spec_hash: self.spec_hash,
            engine,
            tags: self.tags,
            mesh_ids: self.mesh_ids,
            learns_from: None,
            traceparent: None,
            waits_for: None,
        })
    }
}

/// What a mesh is that has to exist.
pub(super) async fn require_mesh(service: &Service, at: &str, mesh: &str) -> ApiResult<String> {
    let row = match id(mesh) {
        Some(id) => service.store.mesh(&id).await?,
        None => None,
    };
    let row = row.ok_or_else(|| fault(at, ErrorCode::UnknownMesh, "there is no such mesh"))?;
    Ok(document_of(&row)?.identity())
}

pub(super) fn fault(at: &str, code: ErrorCode, detail: &str) -> ApiError {
    let mut faults = Faults::default();
    faults.add(&Pointer::from_text(at), code, detail);
    match faults.into_result() {
        Err(problem) => problem.into(),
        Ok(()) => ApiError::internal("a fault vanished"),
    }
}

/// A body that is the spec itself has no `/spec`.
pub(super) fn in_spec(problem: Problem) -> Problem {
    problem.moved("/spec", "")
}

/// The findings of a check, as the response to its request.
pub fn refusal(error: JobError) -> ApiError {
    match error {
        JobError::Refused(problem) => problem.into(),
        JobError::Source(source @ SourceError::Unreadable { may_pass: false, .. }) => {
            tracing::error!(error = %source, "a stored mesh cannot be read");
            ApiError::new(ErrorCode::Integrity, source.to_string())
        }
        JobError::Source(SourceError::Unreadable { may_pass: true, .. }) => ApiError::unavailable(),
        other => {
            let document = other.to_document();
            let mut problem = Problem::new(other.kind(), document.detail);
            problem.members = document.members;
            problem.into()
        }
    }
}

/// The meshes that a prediction is compared with have to exist.
pub(super) async fn require_compared(
    service: &Service,
    spec: &PredictDocument,
) -> ApiResult<Vec<String>> {
    let mut named = Vec::new();
    if let Some(mut compare_to) = spec.compare_to.clone() {
        let at = Pointer::root().key("compare_to");
        for (at, mesh) in compare_to.mesh_references_mut(&at) {
            require_mesh(service, at.as_str(), mesh).await?;
            named.push(mesh.clone());
        }
    }
    Ok(named)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[tokio::test]
    async fn a_check_beyond_its_time_is_refused_with_the_limit_and_one_within_it_is_not() {
        let folder = tempfile::TempDir::new().unwrap();
        let mut service = Service::example(folder.path(), &[("check-s", "3600")]).await;
        let check = |_: &Limits, stop: &StopQuery| match stop.is_asked() {
            true => Err(JobError::Cancelled),
            false => Ok(7),
        };
        assert_eq!(checked_in_time(&service, check).await.ok(), Some(7));
        service.limits = Arc::new(Limits { check_s: 0.0, ..(*service.limits).clone() });
        let problem = checked_in_time(&service, check).await.err().unwrap().problem;
        assert_eq!((problem.code, problem.code.status()), (ErrorCode::BudgetExceeded, 422));
        assert_eq!(
            (&problem.members["which"], &problem.members["allowed_s"]),
            (&"check".into(), &0.0.into())
        );
        assert!(problem.detail.contains("more than 0 s"), "{}", problem.detail);
    }
}
