//! Job output: what a job made, and the place where it works.

use std::path::Path;

use super::source::{MeshSource, StoredShape};
use crate::schema::predict::keep::MadeName;
use crate::schema::predict::result::{FileDocument, ResultDocument};
use crate::schema::{Limits, WarningDocument};
use mechanics::mesh::Frame;

/// Output of a job.
#[derive(Clone, Debug)]
pub struct JobOutput {
    /// The content of `result.json`.
    pub result: ResultDocument,
    /// Every file in the folder, with `result.json` itself.
    pub files: Vec<FileDocument>,
    /// To be stored as meshes; the service does so when it publishes the result, and names them there.
    pub meshes: Vec<MadeMesh>,
}

/// A mesh that a job leaves for others, in mm.
#[derive(Clone, Debug)]
pub struct MadeMesh {
    pub what: MadeName,
    /// Of a bone, that of its segment.
    pub name: Option<String>,
    pub shape: StoredShape,
    pub frame: Frame,
    /// What its meshing has to say, which every job on it says too.
    pub told: Vec<WarningDocument>,
}

/// Where a job finds its meshes, what it is allowed, and where its files go.
pub struct JobContext<'a> {
    pub sources: &'a dyn MeshSource,
    pub limits: &'a Limits,
    pub out: &'a Path,
}
