//! From the document of learning to a job: the predictions read that it names.

use std::collections::BTreeSet;

use super::Service;
use super::accepted::{Accepted, fault, in_spec, require_mesh, successful_job};
use super::error::{ApiError, ApiResult};
use super::stored_cohort::Members;
use crate::jobs::{JobInput, LearnInput, LearnedCase};
use crate::schema::cohort::stored::{CohortUse, CohortVersionDocument};
use crate::schema::learn::model::MODEL_FILE;
use crate::schema::{ErrorCode, Faults, LearnDocument, Pointer, Problem};
use crate::store::{NewJob, Outdated};

/// Learning from predictions that have ended. It belongs to their cases, and goes with each: erasing a case erases every model
/// that was learned from it.
pub async fn of_learning(service: &Service, mut spec: LearnDocument) -> ApiResult<NewJob> {
    check(service, &spec)?;
    let Some(cohort) = spec.cohort.take() else { return of_cases(service, spec, None).await };
    let stored = Members::of(service, &cohort, CohortUse::Learn).await?;
    stored.learn(&mut spec);
    let to_members = |problem: Problem| problem.moved("/cases", "/cohort/members");
    let accepted = match stored.is_empty() {
        true => Err(fault("/cases", ErrorCode::OutOfRange, "every member has left the cohort")),
        false => of_cases(service, spec, Some(stored.version)).await,
    };
    accepted.map_err(|error| error.map_problem(to_members))
}

fn check(service: &Service, spec: &LearnDocument) -> ApiResult<()> {
    let mut faults = Faults::default();
    spec.check(&service.limits, &mut faults);
    faults.into_result().map_err(in_spec)?;
    Ok(())
}

/// Learning from cases, which may be the members of a stored cohort.
async fn of_cases(
    service: &Service,
    spec: LearnDocument,
    cohort: Option<CohortVersionDocument>,
) -> ApiResult<NewJob> {
    check(service, &spec)?;
    let mut cases = Vec::new();
    let mut mesh_ids = Vec::new();
    let mut owners = BTreeSet::new();
    for (index, case) in spec.cases.iter().enumerate() {
        let at = format!("/cases/{index}");
        let learned = learned(service, &format!("{at}/prediction"), &case.prediction).await?;
        if let Some(owner) = &learned.case
            && !owners.insert(owner.clone())
        {
            let detail = "its case is there twice: a patient who is learned from and predicted proves nothing";
            return Err(fault(&format!("{at}/prediction"), ErrorCode::DuplicateName, detail));
        }
        learned.check_settings(&Pointer::from_text(&format!("{at}/prediction")))?;
        require_mesh(service, &format!("{at}/actual"), &case.actual).await?;
        mesh_ids.push(case.actual.clone());
        mesh_ids.extend(learned.prediction.mesh_ids());
        cases.push(learned);
    }
    mesh_ids.sort_unstable();
    mesh_ids.dedup();
    let tags = spec.tags.clone();
    let learns_from = cohort.as_ref().map(|cohort| (cohort.id.clone(), cohort.version));
    let input = LearnInput { job: None, queue_s: None, spec, cohort, cases };
    let spec_hash = input.spec_hash();
    let (case_id, shared_cases, study) = (None, owners.into_iter().collect(), None);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    Ok(NewJob { learns_from, ..new.with(&JobInput::Learn(input))? })
}

/// The cases that a model was learned from, none of which may be the one that it is asked of; a prediction that it corrects goes
/// with each of them.
pub async fn learned_from(service: &Service, model: &str, case: &str) -> ApiResult<Vec<String>> {
    const AT: &str = "/correction/model";
    let row = successful_job(service, AT, model).await?;
    if service.store.job_file(&row.id, MODEL_FILE).await?.is_none() {
        return Err(fault(AT, ErrorCode::NoSuchOutput, "the job learned nothing"));
    }
    if let Some(outdated) = service.store.outdated(&row.id).await? {
        let Outdated { cohort, learned, version } = outdated;
        let detail = format!(
            "the model learned from version {learned} of cohort {cohort}, which is at version {version}: members have left, and it is to be learned again"
        );
        return Err(fault(AT, ErrorCode::ModelStale, &detail));
    }
    let cases = service.store.cases_of_job(&row.id).await?;
    match cases.iter().any(|own| own == case) {
        true => {
            let detail = "the model was learned from this case: its correction repeats what it was trained with";
            Err(fault(AT, ErrorCode::DuplicateName, detail))
        }
        false => Ok(cases),
    }
}

/// What a prediction was asked that has ended well.
pub(super) async fn learned(service: &Service, at: &str, job: &str) -> ApiResult<LearnedCase> {
    let row = successful_job(service, at, job).await?;
    let document = service.store.job_document(&row.id).await?.unwrap_or_default();
    let input: JobInput = serde_json::from_str(&document)
        .map_err(ApiError::unreadable("the input of job", &row.id))?;
    match input {
        JobInput::Predict(mut prediction) => {
            // What it was compared with or corrected by is not learned from.
            (prediction.spec.compare_to, prediction.spec.correction) = (None, None);
            Ok(LearnedCase { case: row.case_id, spec_hash: Some(row.spec_hash), prediction })
        }
        JobInput::Compare(_)
        | JobInput::Response(_)
        | JobInput::Optimise(_)
        | JobInput::Reproduce(_)
        | JobInput::Cohort(_)
        | JobInput::Learn(_)
        | JobInput::Conform(_)
        | JobInput::Meshing(_)
        | JobInput::Study(_) => Err(fault(at, ErrorCode::NoSuchOutput, "the job is no prediction")),
    }
}
