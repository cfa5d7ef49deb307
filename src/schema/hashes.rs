//! The hash of each kind of job and the key of a response: the same work has the same hash, for every client.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::case::document::CaseDocument;
use super::cohort::document::CohortDocument;
use super::cohort::stored::CohortVersionDocument;
use super::compare::document::CompareDocument;
use super::compare::result::ComparisonDocument;
use super::conform::document::ConformDocument;
use super::meshing::document::MeshingDocument;
use super::optimise::document::OptimiseDocument;
use super::plan::document::PlanDocument;
use super::predict::document::PredictDocument;
use super::reproduce::document::ReproduceDocument;
use super::response::ResponseDocument;
use super::study::document::StudyDocument;
use super::wire::canonical::{hash, to_value};
use super::wire::fault::Pointer;

/// The hash of a prediction: contents of meshes instead of their ids, the plan in full, without names and tags.
/// `content_of` gives the SHA-256 of a mesh by its id; an unknown id stays.
pub fn predict_hash(
    case: &CaseDocument,
    plan: &PlanDocument,
    spec: &PredictDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    let mut plan = plan.unnamed();
    let mut spec = spec.clone();
    for (_, id) in plan.surface_references_mut() {
        replace(id, content_of);
    }
    if let Some(compare_to) = &mut spec.compare_to {
        for (_, id) in compare_to.mesh_references_mut(&Pointer::root()) {
            replace(id, content_of);
        }
    }
    hash(json!({
        "case": stated(case, content_of),
        "plan": to_value(&plan),
        "spec": spec.content(),
    }))
}

/// A case with contents of meshes instead of their ids, without name and tags.
pub fn stated(case: &CaseDocument, content_of: &dyn Fn(&str) -> Option<String>) -> Value {
    let mut case = case.clone();
    case.name = None;
    case.tags.clear();
    for (_, id) in case.mesh_references_mut() {
        replace(id, content_of);
    }
    to_value(&case)
}

/// The hash of inverse planning: contents of meshes instead of their ids, without names and tags.
pub fn optimise_hash(
    case: &CaseDocument,
    spec: &OptimiseDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    let mut spec = spec.clone();
    for id in spec.surfaces_mut() {
        replace(id, content_of);
    }
    hash(json!({
        "case": stated(case, content_of),
        "spec": spec.content(),
    }))
}

/// The hash of a study: its cases with contents of meshes instead of their ids, in the order of its scenes, and the
/// report of its baseline; with names of cases, which rows contain, and without those of plans.
pub fn study_hash(
    cases: &[&CaseDocument],
    spec: &StudyDocument,
    baseline: Option<&Value>,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    let mut cases: Vec<CaseDocument> = cases.iter().map(|case| (*case).clone()).collect();
    for case in &mut cases {
        case.tags.clear();
        for (_, id) in case.mesh_references_mut() {
            replace(id, content_of);
        }
    }
    let mut spec = spec.clone();
    for plan in spec.plan_documents_mut() {
        plan.name = None;
        for (_, id) in plan.surface_references_mut() {
            replace(id, content_of);
        }
    }
    if let Some(job) = spec.truth.as_mut().and_then(|truth| truth.job.as_mut()) {
        replace(job, content_of);
    }
    for (_, id) in spec.truth_meshes_mut() {
        replace(id, content_of);
    }
    hash(json!({
        "cases": cases.iter().map(to_value).collect::<Vec<_>>(),
        "spec": spec.content(),
        "baseline": baseline,
    }))
}

/// The key of the rows of a study: its hash without the rules of the outcome.
pub fn rows_key(
    cases: &[&CaseDocument],
    spec: &StudyDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    study_hash(cases, &spec.without_rules(), None, content_of)
}

/// The hash of a comparison; `content_of` also takes the predicted skin of a job.
pub fn compare_hash(spec: &CompareDocument, content_of: &dyn Fn(&str) -> Option<String>) -> String {
    let mut spec = spec.clone();
    spec.tags.clear();
    let reference = &mut spec.prediction;
    let prediction = [reference.job.as_mut(), reference.mesh.as_mut()];
    for id in prediction.into_iter().flatten() {
        replace(id, content_of);
    }
    replace(&mut spec.actual.mesh, content_of);
    for (_, id) in spec.align.surfaces_mut(&Pointer::root()) {
        replace(id, content_of);
    }
    hash(json!({ "spec": to_value(&spec) }))
}

/// The hash of a reproduction: contents of meshes instead of their ids, without tags.
pub fn reproduce_hash(
    spec: &ReproduceDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    let mut spec = spec.clone();
    spec.tags.clear();
    for (_, id) in spec.mesh_references_mut() {
        replace(id, content_of);
    }
    hash(json!({ "spec": to_value(&spec) }))
}

/// The hash of a conformation: contents of meshes instead of their ids, without tags.
pub fn conform_hash(spec: &ConformDocument, content_of: &dyn Fn(&str) -> Option<String>) -> String {
    let mut spec = spec.clone();
    spec.tags.clear();
    for (_, id) in spec.mesh_references_mut() {
        replace(id, content_of);
    }
    hash(json!({ "spec": to_value(&spec) }))
}

/// The hash of a cohort: results of the comparisons instead of their ids, without tags, and their stored cohort.
pub fn cohort_hash(
    spec: &CohortDocument,
    stored: Option<&CohortVersionDocument>,
    comparisons: &BTreeMap<String, ComparisonDocument>,
) -> String {
    let mut spec = spec.clone();
    spec.tags.clear();
    for job in spec.groups.values_mut().flatten() {
        *job = hash(json!({ "comparison": comparisons.get(job).map(to_value) }));
    }
    match stored {
        None => hash(json!({ "spec": to_value(&spec) })),
        Some(stored) => hash(json!({ "spec": to_value(&spec), "cohort": to_value(stored) })),
    }
}

/// The hash of a meshing: the contents of the scan or the surfaces instead of their ids, without tags. One that a case waits
/// for belongs to that case, so that it is erased with it.
pub fn meshing_hash(
    spec: &MeshingDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
    case: Option<&str>,
) -> String {
    let mut spec = spec.clone();
    for (_, id) in spec.mesh_references_mut(&Pointer::root()) {
        replace(id, content_of);
    }
    match case {
        None => hash(json!({ "spec": spec.content() })),
        Some(case) => hash(json!({ "spec": spec.content(), "case": case })),
    }
}

/// The hash of a job on a case that has no mesh yet, until it has one: `asked` is its document without the case and tags.
pub fn waiting_hash(case: &str, asked: &Value) -> String {
    hash(json!({ "waiting": asked, "case": case }))
}

/// Changes with the content of the description of a response, so that earlier ones are not reused.
const DESCRIPTION_REVISION: u32 = 2;

/// The key of a response: the case but for its name, tags, landmarks and skin regions, contents of meshes in
/// place of their ids. The case's own id is part of it, so that a response is erased with its case.
pub fn response_key(
    case: &CaseDocument,
    spec: &ResponseDocument,
    content_of: &dyn Fn(&str) -> Option<String>,
) -> String {
    let mut case = case.clone();
    case.name = None;
    case.tags.clear();
    case.landmarks.clear();
    case.bone_landmarks.clear();
    case.skin_regions.clear();
    for (_, id) in case.mesh_references_mut() {
        replace(id, content_of);
    }
    hash(json!({
        "case": to_value(&case),
        "spec": spec.content(),
        "description": DESCRIPTION_REVISION,
    }))
}

fn replace(id: &mut String, content_of: &dyn Fn(&str) -> Option<String>) {
    if let Some(content) = content_of(id) {
        *id = content;
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_hash_of_a_job_and_the_key_of_a_response_are_made_in_one_place() {
        let code = include_str!("hashes.rs").split("#[cfg(test)]").next().unwrap_or_default();
        let made = code.matches("hash(json!(").count();
        assert_eq!((made, code.matches("sha256_hex(").count()), (13, 0));
    }
}
