//! The case, the plan and the predicted skin that a document names.

use super::Service;
use super::accepted::{fault, successful_job};
use super::error::{ApiError, ApiResult};
use super::parameters::id;
use crate::schema::ErrorCode;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{PlanDocument, PredictDocument};
use crate::store::CaseRow;

/// The plan of a spec, taken out of it; without one nothing moves.
pub async fn plan_of(
    service: &Service,
    case: &str,
    spec: &mut PredictDocument,
) -> ApiResult<PlanDocument> {
    let plan = match spec.plan.take() {
        Some(plan) => Some(plan),
        None => stored_plan(service, case, spec.plan_id.as_deref()).await?,
    };
    Ok(plan.unwrap_or_default())
}

/// The plan of a case that a document names, if it names one.
pub async fn stored_plan(
    service: &Service,
    case: &str,
    named: Option<&str>,
) -> ApiResult<Option<PlanDocument>> {
    let Some(text) = named else { return Ok(None) };
    let found = match id(text) {
        Some(id) => service.store.plan(case, &id).await?,
        None => None,
    };
    let unknown = || {
        fault(
            "/plan_id",
            ErrorCode::UnknownPlan,
            "the case has no such plan: GET /v1/cases/{id}/plans lists those it has",
        )
    };
    let found = found.ok_or_else(unknown)?;
    serde_json::from_str(&found.document).map(Some).map_err(ApiError::unreadable("plan", &found.id))
}

/// A case that has to exist.
pub async fn require_case(service: &Service, case: &str) -> ApiResult<CaseRow> {
    let row = match id(case) {
        Some(id) => service.store.case(&id).await?,
        None => None,
    };
    row.ok_or_else(|| {
        fault(
            "/case",
            ErrorCode::UnknownCase,
            "there is no such case: GET /v1/cases lists the existing ones",
        )
    })
}

/// The skin that a job predicted.
pub struct PredictedSkin {
    /// Its hash.
    pub blob: String,
    /// Of the job.
    pub case: Option<String>,
    /// None of a program whose results this one does not read.
    pub result: Option<ResultDocument>,
}

pub async fn predicted_skin(service: &Service, at: &str, job: &str) -> ApiResult<PredictedSkin> {
    let row = successful_job(service, at, job).await?;
    let skin = service.store.job_file(&row.id, "skin.vtp").await?;
    let skin = skin.ok_or_else(|| {
        fault(
            at,
            ErrorCode::NoSuchOutput,
            "the job wrote no skin.vtp: name a prediction whose `outputs` have it",
        )
    })?;
    let result = row.result.as_deref().and_then(|result| serde_json::from_str(result).ok());
    Ok(PredictedSkin { blob: skin.blob, case: row.case_id, result })
}
