//! The documents of a study, and the scenes that are made of them.

use std::collections::BTreeMap;

use crate::jobs::source::MeshSource;
use crate::schema::predict::result::InputDocument;
use crate::schema::study::document::StudyDocument;
use crate::schema::{CaseDocument, Limits, Pointer};
use mechanics::mesh::Warning;
use mechanics::study::StudyScene;

/// Where the documents of a study stand.
pub(super) struct Documents<'a> {
    pub spec: &'a StudyDocument,
    /// The cases of the spec by their ids.
    pub cases: &'a BTreeMap<String, CaseDocument>,
    pub sources: &'a dyn MeshSource,
    pub limits: &'a Limits,
}

/// Scenes, and where they came from.
#[derive(Default)]
pub(super) struct Scenes {
    pub scenes: Vec<StudyScene>,
    pub inputs: Vec<InputDocument>,
    /// The SHA-256 of each mesh and of the skin of the truth's job, by its id.
    pub contents: BTreeMap<String, String>,
    /// Of each case what it was stated as, by the name of its scene.
    pub stated: BTreeMap<String, StatedHashes>,
    /// The series of each scene that belongs to one, by its name.
    pub series: BTreeMap<String, String>,
    pub warnings: Vec<Warning>,
}

/// SHA-256 of what a case states and of each of its plans, by their names.
#[derive(Clone, Debug, Default)]
pub struct StatedHashes {
    pub case: String,
    pub plans: BTreeMap<String, String>,
}

pub(super) fn spec_at() -> Pointer {
    Pointer::root().key("spec")
}
