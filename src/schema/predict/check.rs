//! The answer of a check: what every node is held to, before anything is solved.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::refine::RefineBoundDocument;
use crate::schema::case::hounsfield::ImagedTissueDocument;
use crate::schema::wire::warning::WarningDocument;

/// Wrong sets are the commonest mistake: these counts show them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CheckDocument {
    pub nodes: u64,
    pub cells: u64,
    pub classes: ClassCounts,
    pub skin: SkinSummary,
    /// What an image shows of the mesh, where materials come from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub imaged: Option<ImagedTissueDocument>,
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
    /// The method that `auto` chooses.
    pub method: String,
    pub why: String,
    pub warnings: Vec<WarningDocument>,
}

/// From mesh in memory to displacement in memory on one thread of a machine like the one that measured the table of
/// methods: an order of magnitude, not a promise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimeBandDocument {
    /// As fast as the best row, time growing with the unknowns.
    pub low: f64,
    /// As slow as the worst row, time growing with their power 4/3.
    pub high: f64,
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
