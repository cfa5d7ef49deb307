//! The documents of a study, and the scenes that are made of them.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::jobs::source::MeshSource;
use crate::schema::hashes;
use crate::schema::predict::result::InputDocument;
use crate::schema::study::document::StudyDocument;
use crate::schema::study::truth::TruthMethodName;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, Limits, PlanDocument, Pointer, Problem};
use mechanics::mesh::Warning;
use mechanics::progress::StopQuery;
use mechanics::study::StudyScene;

/// The places of the documents of a study.
pub(super) struct Documents<'a> {
    pub spec: &'a StudyDocument,
    /// The cases of the spec by their ids.
    pub cases: &'a BTreeMap<String, CaseDocument>,
    /// Of the job of its truth.
    pub truth_method: Option<TruthMethodName>,
    pub sources: &'a dyn MeshSource,
    pub limits: &'a Limits,
    pub stop: &'a StopQuery<'a>,
}

/// Scenes, and their origins.
#[derive(Default)]
pub(super) struct Scenes {
    pub scenes: Vec<StudyScene>,
    pub inputs: Vec<InputDocument>,
    /// The SHA-256 of each mesh and of the skin of the truth's job, by its id.
    pub contents: BTreeMap<String, String>,
    /// Of each case its hashes as stated, by the name of its scene.
    pub stated: BTreeMap<String, StatedHashes>,
    /// The series of each scene in one, by its name.
    pub series: BTreeMap<String, String>,
    pub warnings: Vec<Warning>,
    /// The mistakes of cases, plans and materials.
    pub refused: Vec<Problem>,
}

impl Scenes {
    /// Keeps a mistake of a document, to be told with those of the others; any other error ends the work.
    pub fn found<T>(&mut self, result: Result<T, JobError>) -> Result<Option<T>, JobError> {
        match result {
            Ok(found) => Ok(Some(found)),
            Err(JobError::Refused(problem)) => {
                self.refused.push(problem);
                Ok(None)
            }
            Err(other) => Err(other),
        }
    }
}

/// SHA-256 of a case's document and of each of its plans, by their names.
#[derive(Clone, Debug, Default)]
pub struct StatedHashes {
    pub case: String,
    pub plans: BTreeMap<String, String>,
}

impl StatedHashes {
    /// Of a case and its plans, named by their numbers.
    pub(super) fn of<'a>(
        case: &CaseDocument,
        plans: impl Iterator<Item = &'a PlanDocument>,
        prepared: &Prepared,
    ) -> StatedHashes {
        let content = |id: &str| prepared.contents.get(id).cloned();
        let hash = |stated: Value| canonical::sha256_hex(stated.to_string().as_bytes());
        let plan = |(number, plan): (usize, &PlanDocument)| {
            (format!("plan {number}"), hash(canonical::to_value(&plan.unnamed())))
        };
        let case = hash(hashes::stated(case, &content));
        StatedHashes { case, plans: (1..).zip(plans).map(plan).collect() }
    }
}

pub(super) fn spec_at() -> Pointer {
    Pointer::root().key("spec")
}
