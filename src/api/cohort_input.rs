//! From the document of a cohort to a job: the comparisons read that it names.

use std::collections::{BTreeMap, BTreeSet};

use super::Service;
use super::accepted::{Accepted, fault, in_spec};
use super::error::{ApiError, ApiResult};
use super::parameters::id;
use crate::jobs::{CohortInput, JobInput};
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::job::JobStatus;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{CohortDocument, ErrorCode, Faults};
use crate::store::NewJob;

/// The file that holds what a job found.
const RESULT: &str = "result.json";

/// A cohort of comparisons that have ended. It belongs to their cases, and goes with each.
pub async fn of_cohort(service: &Service, spec: CohortDocument) -> ApiResult<NewJob> {
    let mut faults = Faults::default();
    spec.check(&service.limits, &mut faults);
    faults.into_result().map_err(in_spec)?;
    let mut comparisons = BTreeMap::new();
    let mut owners = BTreeSet::new();
    for (at, job) in spec.jobs() {
        comparisons.insert(job.clone(), comparison(service, at.as_str(), job).await?);
        owners.extend(service.store.cases_of_job(job).await?);
    }
    let tags = spec.tags.clone();
    let input = CohortInput { job: None, queue_s: None, spec, comparisons };
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

/// What a job found that compared.
async fn comparison(service: &Service, at: &str, job: &str) -> ApiResult<ComparisonDocument> {
    let row = match id(job) {
        Some(id) => service.store.job(&id).await?,
        None => None,
    };
    let row = row.ok_or_else(|| fault(at, ErrorCode::UnknownJob, "there is no such job"))?;
    if row.status != JobStatus::Successful {
        let detail = format!("the job is {}, and has to be successful", row.status.name());
        return Err(fault(at, ErrorCode::ResultNotReady, &detail));
    }
    let missing = || fault(at, ErrorCode::NoSuchOutput, "the job compared nothing");
    let file = service.store.job_file(&row.id, RESULT).await?.ok_or_else(missing)?;
    let bytes = service.store.read_blob(&file.blob).await?;
    let result: ResultDocument = serde_json::from_slice(&bytes).map_err(ApiError::internal)?;
    result.comparison.ok_or_else(missing)
}
