//! A checked scene: nothing optional, nothing left to refuse.

use std::collections::BTreeMap;

use super::case::{Case, Plan, Settings};
use crate::mesh::{TriangleSurface, Warning};

/// What holds a node, strongest first (the precedence of the documents).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NodeClass {
    Prescribed,
    /// The number of the segment in the case.
    Joined(u32),
    Fixed,
    Sliding,
    Free,
}

/// The surface whose movement is the answer.
#[derive(Clone, Debug)]
pub struct Skin {
    /// With `node_ids`.
    pub surface: TriangleSurface,
    /// Named parts as ascending points of `surface`.
    pub regions: BTreeMap<String, Vec<u32>>,
}

/// Everything wrong with a case and a plan, at most 50 entries.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{} problems, the first: {}", .0.len(), .0[0])]
pub struct SceneErrors(pub Vec<SceneError>);

/// One thing wrong, and where: a JSON pointer that starts with `/case`, `/plan` or `/spec`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{pointer}: {detail}")]
pub struct SceneError {
    pub pointer: String,
    /// A stable word, e.g. `empty-selection`, `unknown-segment`, `plan-conflict`, `underconstrained`.
    pub code: &'static str,
    pub detail: String,
}

/// Mesh, materials and conditions, ready to be solved.
pub struct Scene {
    pub skin: Skin,
    /// For each node of the volume mesh.
    pub node_classes: Vec<NodeClass>,
    /// Segment names by the number in `NodeClass::Joined`.
    pub segments: Vec<String>,
    /// What a reader must know before anything is solved: overlaps, tearing, locking, default material.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// Checks a case and a plan together.
    pub fn new(_case: &Case, _plan: &Plan, _settings: &Settings) -> Result<Scene, SceneErrors> {
        unimplemented!("the numerics land on main while you work; code against this signature")
    }
}
