//! Answer of a check: the boundary condition of every node, before anything is solved.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::expectation::ExpectationDocument;
use super::planned::{
    BoneContactDocument, CollisionDocument, MeasureDocument, MovementReportDocument,
    SymmetryDocument,
};
use super::refine::RefineBoundDocument;
use super::time_band::TimeBandDocument;
use crate::schema::case::hounsfield::ImagedTissueDocument;
use crate::schema::case::muscle_mixing::MusclesDocument;
use crate::schema::repair::RepairResultDocument;
use crate::schema::wire::warning::WarningDocument;

/// Wrong sets are the commonest mistake: these counts show them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CheckDocument {
    pub nodes: u64,
    pub cells: u64,
    pub classes: ClassCounts,
    pub skin: SkinSummary,
    /// Of the volume, where the case asks for a repair.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub repair: Option<RepairResultDocument>,
    /// What an image shows of the mesh, where materials come from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub imaged: Option<ImagedTissueDocument>,
    /// The muscles of the case in the cells of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub muscles: Option<MusclesDocument>,
    /// Unknown displacement components.
    pub unknowns: u64,
    /// What the process of the job is expected to take; above `slot_memory_mb` of the limits the job is refused.
    pub memory_mb: f64,
    /// Where the table of measured times covers the method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub time_s: Option<TimeBandDocument>,
    /// Where the spec has the mesh refined; numbers above are those of the mesh as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub refine: Option<RefineBoundDocument>,
    /// The method that was asked for, or the one that `auto` begins with.
    pub method: String,
    pub why: String,
    /// What `auto` is expected to choose; absent where a method is asked for or no estimate can choose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub auto: Option<ExpectationDocument>,
    /// Segments that the plan moves, for navigation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub movements: Vec<MovementReportDocument>,
    /// Bones that the plan moves into each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub collisions: Vec<CollisionDocument>,
    /// Where bones that the plan moves against each other touch, before and as planned: the occlusion, of jaws with their
    /// teeth.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<BoneContactDocument>,
    /// Measures of the head before and as planned, of the landmarks that the case states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cephalometry: Vec<MeasureDocument>,
    /// Pairs of landmarks and landmarks of the middle against the mid-sagittal plane, before and as planned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub symmetry: Vec<SymmetryDocument>,
    pub warnings: Vec<WarningDocument>,
}

/// How many nodes are held by what; each node is counted once, by the strongest that holds it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ClassCounts {
    pub prescribed: u64,
    /// By segment.
    pub joined: BTreeMap<String, u64>,
    pub fixed: u64,
    pub sliding: u64,
    pub free: u64,
}

/// The surface whose movement is the answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SkinSummary {
    pub nodes: u64,
    pub triangles: u64,
    pub area_mm2: f64,
    /// Nodes of each of `skin_regions`.
    pub regions: BTreeMap<String, u64>,
}
