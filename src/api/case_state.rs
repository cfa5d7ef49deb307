//! State of a case: complete, being meshed, or without a mesh because its meshing failed.

use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

use super::Service;
use super::error::{ApiError, ApiResult};
use crate::schema::case::meshed::CaseBody;
use crate::schema::job::{ErrorClass, JobErrorDocument, JobStatus};
use crate::schema::link::Link;
use crate::schema::wire::problem::Problem;
use crate::schema::{CaseDocument, ErrorCode, MaterialDocuments};
use crate::store::{CaseMeshing, CaseRow};

/// Whether predictions on a case are possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CaseState {
    /// It has its mesh.
    Ready,
    /// A job makes its mesh; jobs on it wait.
    Meshing,
    /// That job failed.
    Failed,
}

impl CaseState {
    pub fn name(self) -> &'static str {
        match self {
            CaseState::Ready => "ready",
            CaseState::Meshing => "meshing",
            CaseState::Failed => "failed",
        }
    }
}

/// The job that makes or made the mesh of a case.
#[derive(Serialize, ToSchema)]
pub struct CaseMeshingView {
    pub job: String,
    /// Why there is no mesh, if the case has failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<JobErrorDocument>,
    pub link: Link,
}

/// The state of a case by its document.
pub fn state(row: &CaseRow, body: &CaseBody) -> CaseState {
    let Some(meshing) = &row.meshing else { return CaseState::Ready };
    match (meshing.status, body) {
        (Some(JobStatus::Accepted | JobStatus::Running), _) => CaseState::Meshing,
        // The job may be removed once the case has its mesh.
        (Some(JobStatus::Successful) | None, CaseBody::Whole(_)) => CaseState::Ready,
        (_, CaseBody::Whole(_) | CaseBody::ToMesh(_)) => CaseState::Failed,
    }
}

pub fn body_of(row: &CaseRow) -> ApiResult<CaseBody> {
    CaseBody::stored(&row.document).map_err(ApiError::unreadable("case", &row.id))
}

/// The ETag of a case beside its version: the same version may be meshing, and fail.
pub fn tag_of(row: &CaseRow, state: CaseState) -> String {
    match state {
        CaseState::Ready => row.version.to_string(),
        CaseState::Meshing | CaseState::Failed => format!("{}-{}", row.version, state.name()),
    }
}

/// The meshing of a case, as shown to clients.
pub fn meshing_view(meshing: &CaseMeshing, state: CaseState) -> ApiResult<CaseMeshingView> {
    let error = match state {
        CaseState::Failed => Some(error_of(meshing)?),
        CaseState::Ready | CaseState::Meshing => None,
    };
    let link = Link {
        href: format!("/v1/jobs/{}", meshing.job),
        rel: "via".to_owned(),
        media_type: "application/json".to_owned(),
    };
    Ok(CaseMeshingView { job: meshing.job.clone(), error, link })
}

fn error_of(meshing: &CaseMeshing) -> ApiResult<JobErrorDocument> {
    let ended = JobErrorDocument::of_unended_meshing;
    match (&meshing.error, meshing.status) {
        (Some(error), _) => serde_json::from_str(error)
            .map_err(ApiError::unreadable("the error of job", &meshing.job)),
        (None, None) => Ok(ended("removed")),
        (None, Some(_)) => Ok(ended("dismissed")),
    }
}

/// The case of a request that is posted for what its mesh is needed for: a meshing that failed through no fault of its own is
/// accepted again, as any other such job is when it is posted again.
pub async fn meshed_again(service: &Service, row: CaseRow) -> ApiResult<CaseRow> {
    let lost = row.meshing.as_ref().filter(|meshing| {
        let error = (meshing.status == Some(JobStatus::Failed)).then(|| error_of(meshing));
        matches!(error, Some(Ok(error)) if error.class == ErrorClass::Infrastructure)
    });
    let Some(meshing) = lost else { return Ok(row) };
    service.store.requeue(&meshing.job).await?;
    let row = service.store.case(&row.id).await?;
    row.ok_or_else(|| ApiError::not_found("case"))
}

/// The case as input of a job.
pub enum CaseOfJob {
    Whole(Box<CaseDocument>),
    Waits(PendingCase),
}

/// A case whose mesh is being made.
pub struct PendingCase {
    /// The job that makes the mesh.
    pub meshing: String,
    /// As posted beside the scan.
    pub materials: Option<MaterialDocuments>,
}

/// This case as input of a job; refused if there will be no mesh.
pub fn case_of_job(row: &CaseRow) -> ApiResult<CaseOfJob> {
    let body = body_of(row)?;
    let state = state(row, &body);
    match (state, body, &row.meshing) {
        (CaseState::Ready, CaseBody::Whole(case), _) => Ok(CaseOfJob::Whole(case)),
        (CaseState::Meshing, body, Some(meshing)) => {
            let meshing = meshing.job.clone();
            let materials = match body {
                CaseBody::ToMesh(case) => case.materials,
                CaseBody::Whole(case) => case.materials,
            };
            Ok(CaseOfJob::Waits(PendingCase { meshing, materials }))
        }
        _ => Err(not_ready(row, state)),
    }
}

/// The document of a case with its mesh.
pub fn whole(row: &CaseRow) -> ApiResult<CaseDocument> {
    let body = body_of(row)?;
    match (state(row, &body), body) {
        (CaseState::Ready, CaseBody::Whole(case)) => Ok(*case),
        (state, _) => Err(not_ready(row, state)),
    }
}

/// The refusal of a request that needs a missing mesh.
fn not_ready(row: &CaseRow, state: CaseState) -> ApiError {
    let Some(meshing) = &row.meshing else { return ApiError::internal("a case without a mesh") };
    let job = &meshing.job;
    let error = error_of(meshing).ok().filter(|_| state == CaseState::Failed);
    let why = match &error {
        Some(error) => format!("job {job} made none: {}", error.detail),
        None => format!("job {job} makes it"),
    };
    let problem = Problem::new(ErrorCode::CaseNotReady, format!("the case has no mesh: {why}"));
    let error = error.map_or(Value::Null, |error| json!(error));
    let problem = problem.with("state", state.name()).with("job", job.as_str());
    if error.is_null() { problem.into() } else { problem.with("error", error).into() }
}
