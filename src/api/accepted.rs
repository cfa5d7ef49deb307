//! Acceptance of a job: its input is checked with its meshes and queued.

use std::collections::BTreeMap;

use tokio::runtime::Handle;

use super::Service;
use super::error::{ApiError, ApiResult};
use super::parameters::id;
use crate::jobs::{JobError, JobInput, MeshSource, SourceError};
use crate::schema::job::JobStatus;
use crate::schema::predict::result::EngineDocument;
use crate::schema::study::expected::TruthCostDocument;
use crate::schema::{ErrorCode, Faults, Limits, Pointer, PredictDocument, Problem};
use crate::store::{JobRow, NewJob};

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
    prepare: fn(&I, &dyn MeshSource, &Limits) -> Result<T, JobError>,
) -> ApiResult<(I, T)> {
    let sources = service.library.source(Handle::current(), BTreeMap::new());
    let limits: Limits = (*service.limits).clone();
    let permit = service.check_permit().await?;
    let (input, found) = permit
        .compute(move || {
            let found = prepare(&input, &sources, &limits);
            (input, found)
        })
        .await?;
    Ok((input, found.map_err(|error| refusal(error).map_problem(in_spec))?))
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

/// The hash of a mesh that has to exist.
pub(super) async fn require_mesh(service: &Service, at: &str, mesh: &str) -> ApiResult<String> {
    let row = match id(mesh) {
        Some(id) => service.store.mesh(&id).await?,
        None => None,
    };
    let row = row.ok_or_else(|| fault(at, ErrorCode::UnknownMesh, "there is no such mesh"))?;
    Ok(row.sha256)
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
