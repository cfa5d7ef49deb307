//! Job output: the results of a job, and its working context.

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
    /// Every file in the folder, including `result.json`.
    pub files: Vec<FileDocument>,
    /// Meshes to store; the service does so when it publishes the result, with their ids.
    pub meshes: Vec<MadeMesh>,
}

/// A mesh that a job stores for others, in mm.
#[derive(Clone, Debug)]
pub struct MadeMesh {
    pub what: MadeName,
    /// Of a bone, the name of its segment.
    pub name: Option<String>,
    pub shape: StoredShape,
    pub frame: Frame,
    /// The warnings of its meshing, which every job on it repeats.
    pub told: Vec<WarningDocument>,
}

/// The source of a job's meshes, its limits, and its folder.
pub struct JobContext<'a> {
    pub sources: &'a dyn MeshSource,
    pub limits: &'a Limits,
    pub out: &'a Path,
}
