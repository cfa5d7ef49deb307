//! From the document of a study to a job: its cases, plans, baseline and truth read that it names.

use std::collections::{BTreeMap, BTreeSet};

use tokio::runtime::Handle;

use super::Service;
use super::accepted::{Accepted, AcceptedStudy, fault, in_spec, prepared};
use super::case_state::whole;
use super::error::ApiResult;
use super::named_rows::{PredictedSkin, predicted_skin, require_case, stored_plan};
use super::parameters::id;
use super::report;
use crate::jobs::{JobInput, MeshSource, StudyInput};
use crate::schema::study::document::SceneReference;
use crate::schema::study::expected::truth_costs;
use crate::schema::study::truth::TruthMethodName;
use crate::schema::{CaseDocument, ErrorCode, Faults, Limits, ReportDocument, StudyDocument};
use crate::store::NewJob;
use mechanics::progress::StopQuery;

/// A study: its cases and its baseline in their present versions, its scenes made and checked.
pub async fn of_study(service: &Service, mut spec: StudyDocument) -> ApiResult<NewJob> {
    let cases = cases_of_study(service, &mut spec).await?;
    // What it is held against is of patients too, and takes it with them.
    let mut owners: BTreeSet<String> = cases.keys().cloned().collect();
    let baseline = match &spec.baseline {
        None => None,
        Some(job) => {
            let (report, of) = baseline(service, job).await?;
            owners.extend(of);
            Some(Box::new(report))
        }
    };
    let mut truth_method = None;
    if let Some(job) = spec.truth.as_ref().and_then(|truth| truth.job.as_ref()) {
        let PredictedSkin { case, result, .. } = predicted_skin(service, "/truth/job", job).await?;
        owners.extend(case);
        truth_method = result.and_then(|result| TruthMethodName::of(&result.provenance));
    }
    let ids: Vec<String> = owners.into_iter().collect();
    let tags = spec.tags.clone();
    let (job, queue_s, earlier) = (None, None, None);
    let input = StudyInput { job, queue_s, cases, baseline, truth_method, earlier, spec };
    let mesh_ids = input.mesh_ids();
    let prepare =
        |input: &StudyInput, sources: &dyn MeshSource, limits: &Limits, stop: &StopQuery| {
            let prepared = input.prepare(sources, limits, stop)?;
            let truths = truth_costs(&prepared.study);
            Ok((prepared.spec_hash, AcceptedStudy { rows_key: prepared.rows_key, truths }))
        };
    let (mut input, (spec_hash, mut study)) = prepared(service, input, prepare).await?;
    input.earlier = report::with_rows(service, &study.rows_key, &ids).await?.map(Box::new);
    if input.earlier.is_some() {
        study.truths.clear();
    }
    let (case_id, shared_cases) = match ids.as_slice() {
        [only] => (Some(only.clone()), Vec::new()),
        _ => (None, ids),
    };
    let study = Some(study);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    new.with(&JobInput::Study(input))
}

/// The cases of a study in their present versions, with their ids and the plans of items in its spec; all mistakes of the spec are
/// told beside cases and plans that do not exist.
async fn cases_of_study(
    service: &Service,
    spec: &mut StudyDocument,
) -> ApiResult<BTreeMap<String, CaseDocument>> {
    let (mut cases, mut faults) = (BTreeMap::new(), Faults::default());
    for (index, scene) in spec.scenes.iter_mut().enumerate() {
        let SceneReference::Case(reference) = scene else { continue };
        let row = require_case(service, &reference.case).await;
        let at = format!("/scenes/{index}/case");
        let Some(row) = told(row, ("/case", &at), &mut faults)? else { continue };
        reference.case.clone_from(&row.id);
        let case = told(whole(&row), ("/case", &at), &mut faults)?;
        cases.extend(case.map(|case| (row.id, case)));
    }
    for (index, item) in spec.items.iter_mut().enumerate() {
        let at = format!("/items/{index}");
        let row = require_case(service, &item.case).await;
        let Some(row) = told(row, ("", &at), &mut faults)? else { continue };
        item.case.clone_from(&row.id);
        let named = item.plan_id.take();
        if item.plan.is_none() {
            let plan = stored_plan(service, &row.id, named.as_deref()).await;
            item.plan = told(plan, ("", &at), &mut faults)?.flatten();
        }
        let case = told(whole(&row), ("", &at), &mut faults)?;
        cases.extend(case.map(|case| (row.id, case)));
    }
    if !faults.is_empty() {
        let (job, queue_s, baseline, truth_method, earlier) = (None, None, None, None, None);
        let (cases, spec) = (BTreeMap::new(), spec.clone());
        let alone = StudyInput { job, queue_s, cases, baseline, truth_method, earlier, spec };
        let sources = service.library.source(Handle::current(), BTreeMap::new());
        let mut of_spec = Faults::default();
        alone.check_spec(&sources, &service.limits, &mut of_spec);
        if let Err(problem) = of_spec.into_result() {
            faults.join(in_spec(problem));
        }
    }
    faults.into_result()?;
    Ok(cases)
}

/// What was found; a mistake at a place is told with others, by the place `to` for `from`, any other error at once.
fn told<T>(
    found: ApiResult<T>,
    (from, to): (&str, &str),
    faults: &mut Faults,
) -> ApiResult<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.problem.errors.is_empty() => Err(error),
        Err(error) => {
            faults.join(error.problem.moved(from, to));
            Ok(None)
        }
    }
}

/// The report of a baseline, and the cases of that study.
async fn baseline(service: &Service, job: &str) -> ApiResult<(ReportDocument, Vec<String>)> {
    const AT: &str = "/baseline";
    let id = id(job).ok_or_else(|| fault(AT, ErrorCode::UnknownJob, "there is no such job"))?;
    if service.store.job(&id).await?.is_none() {
        return Err(fault(AT, ErrorCode::UnknownJob, "there is no such job"));
    }
    let found = report::stored_report(service, &id).await?;
    let missing = || {
        fault(
            AT,
            ErrorCode::NoSuchOutput,
            "the job is not a successful study: name one of kind `study` or `batch` whose status is `successful`, or omit `baseline`",
        )
    };
    Ok((found.ok_or_else(missing)?.1, service.store.cases_of_job(&id).await?))
}
