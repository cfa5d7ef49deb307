//! Conversion of the body of `POST /v1/jobs` to a job for the queue: references resolved, everything checked.

use std::collections::{BTreeMap, BTreeSet};

use super::Service;
use super::accepted::{
    Accepted, AcceptedStudy, fault, in_spec, prepared, require_compared, require_mesh,
    successful_job,
};
use super::case_state::{CaseOfJob, case_of_job, whole};
use super::cohort_input::of_cohort;
use super::error::{ApiError, ApiResult};
use super::learn_input::{learned_from, of_learning};
use super::parameters::id;
use super::report;
use super::waiting::Waiting;
use crate::jobs::{
    CompareInput, ConformInput, JobInput, MeshSource, MeshingInput, OptimiseInput, PredictInput,
    ReproduceInput, ResponseInput, StudyInput,
};
use crate::schema::ErrorCode;
use crate::schema::hashes::reproduce_hash;
use crate::schema::job_document::JobDocument;
use crate::schema::study::document::SceneReference;
use crate::schema::study::expected::truth_costs;
use crate::schema::{
    CompareDocument, ConformDocument, Faults, Limits, MeshingDocument, OptimiseDocument,
    PlanDocument, Pointer, PredictDocument, ReportDocument, ReproduceDocument, ResponseDocument,
    StudyDocument,
};
use crate::store::{CaseRow, NewJob};

/// The job of a document.
pub async fn of(service: &Service, document: JobDocument) -> ApiResult<NewJob> {
    match document {
        JobDocument::Predict(spec) => of_prediction(service, *spec).await,
        JobDocument::Compare(spec) => of_comparison(service, spec).await,
        JobDocument::Response(spec) => of_response(service, spec).await,
        JobDocument::Optimise(spec) => of_optimisation(service, spec).await,
        JobDocument::Reproduce(spec) => of_reproduction(service, spec).await,
        JobDocument::Cohort(spec) => of_cohort(service, spec).await,
        JobDocument::Learn(spec) => of_learning(service, spec).await,
        JobDocument::Conform(spec) => of_conformation(service, spec).await,
        JobDocument::Mesh(spec) => of_meshing(service, spec).await,
        JobDocument::Study(spec) => of_study(service, *spec).await,
    }
}

/// A prediction: its case and plan in their present versions, checked together with the meshes.
async fn of_prediction(service: &Service, mut spec: PredictDocument) -> ApiResult<NewJob> {
    let row = require_case(service, spec.case.as_deref().unwrap_or_default()).await?;
    let case = match case_of_job(&row)? {
        CaseOfJob::Whole(case) => *case,
        CaseOfJob::Waits(awaited) => {
            if spec.correction.is_some() {
                let detail =
                    "a case that waits for its mesh takes no correction: repeat when it has one";
                return Err(fault("/correction", ErrorCode::MethodNotAvailable, detail));
            }
            let plan = plan_of(service, &row.id, &mut spec).await?;
            return Waiting { case: &row.id, awaited }.prediction(service, plan, spec).await;
        }
    };
    let plan = plan_of(service, &row.id, &mut spec).await?;
    let input = PredictInput { job: None, queue_s: None, case, plan, spec };
    let mesh_ids = input.mesh_ids();
    require_compared(service, &input.spec).await?;
    let shared_cases = match &input.spec.correction {
        Some(correction) => learned_from(service, &correction.model, &row.id).await?,
        None => Vec::new(),
    };
    let tags = input.spec.tags.clone();
    let prepare = |input: &PredictInput, sources: &dyn MeshSource, limits: &Limits| {
        let prepared = input.prepare(sources, limits)?;
        prepared.admit(0, limits)?;
        Ok(prepared.spec_hash)
    };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let new =
        Accepted { case_id: Some(row.id), shared_cases, spec_hash, tags, mesh_ids, study: None };
    new.with(&JobInput::Predict(input))
}

/// A comparison of existing surfaces.
async fn of_comparison(service: &Service, spec: CompareDocument) -> ApiResult<NewJob> {
    let mut faults = Faults::default();
    spec.check(&service.limits, &mut faults);
    faults.into_result().map_err(in_spec)?;
    let mut mesh_ids = Vec::new();
    let mut contents = BTreeMap::new();
    let mut case_id = None;
    for (at, mesh) in spec.clone().mesh_references_mut() {
        contents.insert(mesh.clone(), require_mesh(service, at.as_str(), mesh).await?);
        mesh_ids.push(mesh.clone());
    }
    if let Some(job) = &spec.prediction.job {
        let (skin, case) = predicted_skin(service, "/prediction/job", job).await?;
        contents.insert(job.clone(), skin);
        case_id = case;
    }
    let content_of = |id: &str| contents.get(id).cloned();
    let spec_hash = crate::schema::hashes::compare_hash(&spec, &content_of);
    let tags = spec.tags.clone();
    let input = CompareInput { job: None, queue_s: None, spec };
    let admit = |input: &CompareInput, sources: &dyn MeshSource, _: &Limits| input.admit(sources);
    let (input, ()) = prepared(service, input, admit).await?;
    let new =
        Accepted { case_id, shared_cases: Vec::new(), spec_hash, tags, mesh_ids, study: None };
    new.with(&JobInput::Compare(input))
}

/// A plan response: its case in its present version, checked with its meshes.
async fn of_response(service: &Service, mut spec: ResponseDocument) -> ApiResult<NewJob> {
    let row = require_case(service, &spec.case).await?;
    spec.case.clone_from(&row.id);
    let case = match case_of_job(&row)? {
        CaseOfJob::Whole(case) => *case,
        CaseOfJob::Waits(awaited) => {
            return Waiting { case: &row.id, awaited }.response(service, spec).await;
        }
    };
    let (mesh_ids, tags) = (case.mesh_ids(), spec.tags.clone());
    let input = ResponseInput { job: None, queue_s: None, case, spec };
    let prepare = |input: &ResponseInput, sources: &dyn MeshSource, limits: &Limits| {
        let prepared = input.prepare(sources, limits)?;
        prepared.admit(limits)?;
        Ok(prepared.key)
    };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let case_id = Some(row.id);
    let new =
        Accepted { case_id, shared_cases: Vec::new(), spec_hash, tags, mesh_ids, study: None };
    new.with(&JobInput::Response(input))
}

/// Inverse planning: its case in its present version, checked with its meshes.
async fn of_optimisation(service: &Service, mut spec: OptimiseDocument) -> ApiResult<NewJob> {
    let row = require_case(service, &spec.case).await?;
    spec.case.clone_from(&row.id);
    let case = match case_of_job(&row)? {
        CaseOfJob::Whole(case) => *case,
        CaseOfJob::Waits(awaited) => {
            return Waiting { case: &row.id, awaited }.optimisation(service, spec).await;
        }
    };
    let tags = spec.tags.clone();
    let input = OptimiseInput { job: None, queue_s: None, case, spec };
    let mesh_ids = input.mesh_ids();
    let prepare = |input: &OptimiseInput, sources: &dyn MeshSource, limits: &Limits| {
        let prepared = input.prepare(sources, limits)?;
        prepared.rest.admit(prepared.moving, limits)?;
        Ok(prepared.spec_hash)
    };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let case_id = Some(row.id);
    let new =
        Accepted { case_id, shared_cases: Vec::new(), spec_hash, tags, mesh_ids, study: None };
    new.with(&JobInput::Optimise(input))
}

/// The reproduction of an operation from existing surfaces of bone.
async fn of_reproduction(service: &Service, spec: ReproduceDocument) -> ApiResult<NewJob> {
    let mut faults = Faults::default();
    spec.check(&service.limits, &mut faults);
    faults.into_result().map_err(in_spec)?;
    let mut contents = BTreeMap::new();
    for (at, mesh) in spec.clone().mesh_references_mut() {
        contents.insert(mesh.clone(), require_mesh(service, at.as_str(), mesh).await?);
    }
    let spec_hash = reproduce_hash(&spec, &|id| contents.get(id).cloned());
    let (tags, mesh_ids) = (spec.tags.clone(), contents.into_keys().collect());
    let input = JobInput::Reproduce(ReproduceInput { job: None, queue_s: None, spec });
    let (case_id, shared_cases, study) = (None, Vec::new(), None);
    Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study }.with(&input)
}

/// A conformation: its template and surfaces, checked.
async fn of_conformation(service: &Service, mut spec: ConformDocument) -> ApiResult<NewJob> {
    let mut mesh_ids = Vec::new();
    for (at, id) in spec.mesh_references_mut() {
        require_mesh(service, at.as_str(), id).await?;
        mesh_ids.push(id.clone());
    }
    let tags = spec.tags.clone();
    let input = ConformInput { job: None, queue_s: None, spec };
    let prepare = |input: &ConformInput, sources: &dyn MeshSource, limits: &Limits| {
        Ok(input.prepare(sources, limits)?.spec_hash)
    };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let (case_id, shared_cases, study) = (None, Vec::new(), None);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    new.with(&JobInput::Conform(input))
}

/// A meshing: its scan or its surfaces, checked.
async fn of_meshing(service: &Service, mut spec: MeshingDocument) -> ApiResult<NewJob> {
    let mut mesh_ids = Vec::new();
    for (at, id) in spec.mesh_references_mut(&Pointer::root()) {
        require_mesh(service, at.as_str(), id).await?;
        mesh_ids.push(id.clone());
    }
    let tags = spec.tags.clone();
    let input = MeshingInput { job: None, queue_s: None, spec, case: None };
    let prepare = |input: &MeshingInput, sources: &dyn MeshSource, limits: &Limits| {
        Ok(input.prepare(sources, limits)?.spec_hash)
    };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let (case_id, shared_cases, study) = (None, Vec::new(), None);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    new.with(&JobInput::Meshing(input))
}

/// A study: its cases and its baseline in their present versions, its scenes made and checked.
async fn of_study(service: &Service, mut spec: StudyDocument) -> ApiResult<NewJob> {
    let mut cases = BTreeMap::new();
    for (index, scene) in spec.scenes.iter_mut().enumerate() {
        let SceneReference::Case(reference) = scene else { continue };
        let row = require_case(service, &reference.case).await;
        let at = format!("/scenes/{index}/case");
        let row = row.map_err(|error| error.map_problem(|problem| problem.moved("/case", &at)))?;
        reference.case.clone_from(&row.id);
        let case = whole(&row)?;
        cases.insert(row.id, case);
    }
    for (index, item) in spec.items.iter_mut().enumerate() {
        let row = require_case(service, &item.case).await;
        let at = format!("/items/{index}");
        let row = row.map_err(|error| error.map_problem(|problem| problem.moved("", &at)))?;
        item.case.clone_from(&row.id);
        let named = item.plan_id.take();
        if item.plan.is_none() {
            let plan = stored_plan(service, &row.id, named.as_deref()).await;
            item.plan =
                plan.map_err(|error| error.map_problem(|problem| problem.moved("", &at)))?;
        }
        let case = whole(&row)?;
        cases.insert(row.id, case);
    }
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
    if let Some(job) = spec.truth.as_ref().and_then(|truth| truth.job.as_ref()) {
        owners.extend(predicted_skin(service, "/truth/job", job).await?.1);
    }
    let ids: Vec<String> = owners.into_iter().collect();
    let tags = spec.tags.clone();
    let input = StudyInput { job: None, queue_s: None, cases, baseline, earlier: None, spec };
    let mesh_ids = input.mesh_ids();
    let prepare = |input: &StudyInput, sources: &dyn MeshSource, limits: &Limits| {
        let prepared = input.prepare(sources, limits)?;
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

/// The case and the plan of a spec in full; without a plan nothing moves.
pub async fn predict_input(
    service: &Service,
    row: &CaseRow,
    mut spec: PredictDocument,
) -> ApiResult<PredictInput> {
    let case = whole(row)?;
    let plan = plan_of(service, &row.id, &mut spec).await?;
    Ok(PredictInput { job: None, queue_s: None, case, plan, spec })
}

/// The plan of a spec, taken out of it; without one nothing moves.
async fn plan_of(
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
async fn stored_plan(
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
    serde_json::from_str(&found.document).map(Some).map_err(ApiError::internal)
}

/// A case that has to exist.
async fn require_case(service: &Service, case: &str) -> ApiResult<CaseRow> {
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

/// The hash of the skin that a job predicted, and the job's case.
async fn predicted_skin(
    service: &Service,
    at: &str,
    job: &str,
) -> ApiResult<(String, Option<String>)> {
    let row = successful_job(service, at, job).await?;
    let skin = service.store.job_file(&row.id, "skin.vtp").await?;
    let skin = skin.ok_or_else(|| {
        fault(
            at,
            ErrorCode::NoSuchOutput,
            "the job wrote no skin.vtp: name a prediction whose `outputs` have it",
        )
    })?;
    Ok((skin.blob, row.case_id))
}
