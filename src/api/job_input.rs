//! Conversion of the body of `POST /v1/jobs` to a job for the queue: references resolved, everything checked.

use std::collections::BTreeMap;

use super::Service;
use super::accepted::{Accepted, fault, in_spec, prepared, require_compared, require_mesh};
use super::case_state::{CaseOfJob, case_of_job, meshed_again, whole};
use super::cohort_input::of_cohort;
use super::error::ApiResult;
use super::learn_input::{learned_from, of_learning};
use super::named_rows::{PredictedSkin, plan_of, predicted_skin, require_case};
use super::study_input::of_study;
use super::waiting::Waiting;
use crate::jobs::{
    CompareInput, ConformInput, JobInput, MeshSource, MeshingInput, OptimiseInput, PredictInput,
    ReproduceInput, ResponseInput,
};
use crate::schema::ErrorCode;
use crate::schema::hashes::reproduce_hash;
use crate::schema::job_document::JobDocument;
use crate::schema::{
    CompareDocument, ConformDocument, Faults, Limits, MeshingDocument, OptimiseDocument, Pointer,
    PredictDocument, ReproduceDocument, ResponseDocument,
};
use crate::store::{CaseRow, NewJob};
use mechanics::progress::StopQuery;

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

/// The case of a job that needs its mesh, in its present version.
async fn case_to_solve(service: &Service, named: &str) -> ApiResult<(CaseRow, CaseOfJob)> {
    let row = meshed_again(service, require_case(service, named).await?).await?;
    let case = case_of_job(&row)?;
    Ok((row, case))
}

/// A prediction: its case and plan in their present versions, checked together with the meshes.
async fn of_prediction(service: &Service, mut spec: PredictDocument) -> ApiResult<NewJob> {
    let named = spec.case.as_deref().unwrap_or_default();
    let (row, case) = case_to_solve(service, named).await?;
    let case = match case {
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
    let prepare =
        |input: &PredictInput, sources: &dyn MeshSource, limits: &Limits, stop: &StopQuery| {
            let prepared = input.prepare(sources, limits, stop)?;
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
        let PredictedSkin { blob: skin, case, .. } =
            predicted_skin(service, "/prediction/job", job).await?;
        contents.insert(job.clone(), skin);
        case_id = case;
    }
    let content_of = |id: &str| contents.get(id).cloned();
    let spec_hash = crate::schema::hashes::compare_hash(&spec, &content_of);
    let tags = spec.tags.clone();
    let input = CompareInput { job: None, queue_s: None, spec };
    let admit = |input: &CompareInput, sources: &dyn MeshSource, _: &Limits, _: &StopQuery| {
        input.admit(sources)
    };
    let (input, ()) = prepared(service, input, admit).await?;
    let new =
        Accepted { case_id, shared_cases: Vec::new(), spec_hash, tags, mesh_ids, study: None };
    new.with(&JobInput::Compare(input))
}

/// A plan response: its case in its present version, checked with its meshes.
async fn of_response(service: &Service, mut spec: ResponseDocument) -> ApiResult<NewJob> {
    let (row, case) = case_to_solve(service, &spec.case).await?;
    spec.case.clone_from(&row.id);
    let case = match case {
        CaseOfJob::Whole(case) => *case,
        CaseOfJob::Waits(awaited) => {
            return Waiting { case: &row.id, awaited }.response(service, spec).await;
        }
    };
    let (mesh_ids, tags) = (case.mesh_ids(), spec.tags.clone());
    let input = ResponseInput { job: None, queue_s: None, case, spec };
    let prepare =
        |input: &ResponseInput, sources: &dyn MeshSource, limits: &Limits, stop: &StopQuery| {
            let prepared = input.prepare(sources, limits, stop)?;
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
    let (row, case) = case_to_solve(service, &spec.case).await?;
    spec.case.clone_from(&row.id);
    let case = match case {
        CaseOfJob::Whole(case) => *case,
        CaseOfJob::Waits(awaited) => {
            return Waiting { case: &row.id, awaited }.optimisation(service, spec).await;
        }
    };
    let tags = spec.tags.clone();
    let input = OptimiseInput { job: None, queue_s: None, case, spec };
    let mesh_ids = input.mesh_ids();
    let prepare =
        |input: &OptimiseInput, sources: &dyn MeshSource, limits: &Limits, stop: &StopQuery| {
            let prepared = input.prepare(sources, limits, stop)?;
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
    let prepare =
        |input: &ConformInput, sources: &dyn MeshSource, limits: &Limits, stop: &StopQuery| {
            Ok(input.prepare(sources, limits, stop)?.spec_hash)
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
    let prepare =
        |input: &MeshingInput, sources: &dyn MeshSource, limits: &Limits, _: &StopQuery| {
            Ok(input.prepare(sources, limits)?.spec_hash)
        };
    let (input, spec_hash) = prepared(service, input, prepare).await?;
    let (case_id, shared_cases, study) = (None, Vec::new(), None);
    let new = Accepted { case_id, shared_cases, spec_hash, tags, mesh_ids, study };
    new.with(&JobInput::Meshing(input))
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
