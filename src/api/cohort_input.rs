//! Conversion of a cohort document to a job, with its comparisons read.

use std::collections::{BTreeMap, BTreeSet};

use super::Service;
use super::accepted::{Accepted, fault, in_spec, successful_job};
use super::error::{ApiError, ApiResult};
use super::stored_cohort::Members;
use crate::jobs::{CohortInput, JobInput};
use crate::schema::cohort::stored::{CohortUse, CohortVersionDocument};
use crate::schema::predict::result::ResultDocument;
use crate::schema::{CohortDocument, ErrorCode, Faults};
use crate::store::NewJob;

/// The file with the result of a job.
const RESULT: &str = "result.json";

/// A cohort of successful comparisons. It belongs to their cases, and is erased with each.
pub async fn of_cohort(service: &Service, mut spec: CohortDocument) -> ApiResult<NewJob> {
    check(service, &spec)?;
    let Some(cohort) = spec.cohort.take() else { return of_groups(service, spec, None).await };
    let stored = Members::of(service, &cohort, CohortUse::Compare).await?;
    stored.compare(&mut spec);
    if spec.groups.is_empty() {
        let detail = "no member of the cohort has `comparisons`";
        return Err(fault("/cohort", ErrorCode::NoSuchOutput, detail));
    }
    of_groups(service, spec, Some(stored.version)).await
}

fn check(service: &Service, spec: &CohortDocument) -> ApiResult<()> {
    let mut faults = Faults::default();
    spec.check(&service.limits, &mut faults);
    faults.into_result().map_err(in_spec)?;
    Ok(())
}

/// A cohort by its groups, whose subjects may be the members of a stored one.
async fn of_groups(
    service: &Service,
    spec: CohortDocument,
    cohort: Option<CohortVersionDocument>,
) -> ApiResult<NewJob> {
    check(service, &spec)?;
    let (comparisons, actuals) = (BTreeMap::new(), BTreeMap::new());
    let mut input = CohortInput { job: None, queue_s: None, spec, cohort, comparisons, actuals };
    let mut owners = BTreeSet::new();
    let spec = input.spec.clone();
    for (at, job) in spec.jobs() {
        input.take(job, compared(service, at.as_str(), job).await?);
        owners.extend(service.store.cases_of_job(job).await?);
    }
    let tags = spec.tags;
    let spec_hash = input.spec_hash();
    let owners: Vec<String> = owners.into_iter().collect();
    let (case_id, shared_cases) = match owners.as_slice() {
        [only] => (Some(only.clone()), Vec::new()),
        _ => (None, owners),
    };
    let (mesh_ids, study) = (Vec::new(), None);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    new.with(&JobInput::Cohort(input))
}

fn compared_nothing(at: &str) -> ApiError {
    let detail =
        "the job has no comparison: name jobs of kind `compare`, or predictions with `compare_to`";
    fault(at, ErrorCode::NoSuchOutput, detail)
}

/// The result of a comparison job.
pub(super) async fn compared(service: &Service, at: &str, job: &str) -> ApiResult<ResultDocument> {
    let found = result_of(service, at, job).await?;
    if found.comparison.is_none() {
        return Err(compared_nothing(at));
    }
    Ok(found)
}

/// The result of a job.
async fn result_of(service: &Service, at: &str, job: &str) -> ApiResult<ResultDocument> {
    let row = successful_job(service, at, job).await?;
    let file = service.store.job_file(&row.id, RESULT).await?;
    let file = file.ok_or_else(|| compared_nothing(at))?;
    let bytes = service.store.read_blob(&file.blob).await?;
    serde_json::from_slice(&bytes).map_err(ApiError::unreadable("the result of job", &row.id))
}
