//! Cuts through the segmented bone: their paths, for navigation, and their clearance from structures at risk.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
/// A cut through the bone of a segment, in the frame of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CutPathDocument {
    pub cut: String,
    pub segment: String,
    /// Unit normal, from below to above the cut.
    pub normal: Triple,
    /// Area of sawn bone.
    pub area_mm2: f64,
    /// Outlines of the bone on the plane of the cut, each in its order and closed; of holes in the bone too.
    pub paths_mm: Vec<Vec<Triple>>,
    /// From each structure at risk.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clearances: Vec<ClearanceDocument>,
}

/// The clearance of the saw from a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ClearanceDocument {
    /// Its name.
    pub risk: String,
    /// From the saw to the structure with its radius; negative if the saw enters it.
    pub distance_mm: f64,
    /// The required clearance.
    pub clearance_mm: f64,
    /// The nearest point of its line.
    pub at_mm: Triple,
}
