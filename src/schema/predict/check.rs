//! Result of a check: the boundary condition of every node, before anything is solved.

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

/// Result of a check: its counts show wrong node sets, the most common mistake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CheckDocument {
    pub nodes: u64,
    pub cells: u64,
    pub classes: ClassCounts,
    pub skin: SkinSummary,
    /// Of the volume, if the case requests a repair.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub repair: Option<RepairResultDocument>,
    /// Tissues of the mesh by an image, if materials come from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub imaged: Option<ImagedTissueDocument>,
    /// The muscles of the case in the cells of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub muscles: Option<MusclesDocument>,
    /// Unknown displacement components.
    pub unknowns: u64,
    /// Expected memory of the process; above `slot_memory_mb` of the limits the job is refused.
    pub memory_mb: f64,
    /// Present if the table of measured times covers the method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub time_s: Option<TimeBandDocument>,
    /// If the spec refines the mesh; the numbers above are those of the original mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub refine: Option<RefineBoundDocument>,
    /// The method of the spec, or the first one of `auto`.
    pub method: String,
    pub why: String,
    /// The expected choice of `auto`; absent for other methods or if no estimate can choose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub auto: Option<ExpectationDocument>,
    /// Segments that the plan moves, for navigation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub movements: Vec<MovementReportDocument>,
    /// Collisions of bones under the plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub collisions: Vec<CollisionDocument>,
    /// Contact of bones that the plan moves against each other, before and as planned: the occlusion, of jaws with their
    /// teeth.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<BoneContactDocument>,
    /// Cephalometric measures before and as planned, from the landmarks of the case.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cephalometry: Vec<MeasureDocument>,
    /// Paired and midline landmarks relative to the mid-sagittal plane, before and as planned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub symmetry: Vec<SymmetryDocument>,
    pub warnings: Vec<WarningDocument>,
}

/// The number of nodes in each class; each node counts once, in its strongest class.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ClassCounts {
    pub prescribed: u64,
    /// By segment.
    pub joined: BTreeMap<String, u64>,
    pub fixed: u64,
    pub sliding: u64,
    pub free: u64,
}

/// The skin, whose movement is the result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SkinSummary {
    pub nodes: u64,
    pub triangles: u64,
    pub area_mm2: f64,
    /// Nodes of each of `skin_regions`.
    pub regions: BTreeMap<String, u64>,
}
