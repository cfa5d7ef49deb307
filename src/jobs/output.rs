//! Job output: what a job made, and the place where it works.

use std::path::Path;

use super::source::MeshSource;
use crate::schema::Limits;
use crate::schema::predict::result::{FileDocument, ResultDocument};

/// What a job made.
#[derive(Clone, Debug)]
pub struct JobOutput {
    /// The content of `result.json`.
    pub result: ResultDocument,
    /// Every file in the folder, with `result.json` itself.
    pub files: Vec<FileDocument>,
}

/// Where a job finds its meshes, what it is allowed, and where its files go.
pub struct Workplace<'a> {
    pub sources: &'a dyn MeshSource,
    pub limits: &'a Limits,
    pub out: &'a Path,
}
