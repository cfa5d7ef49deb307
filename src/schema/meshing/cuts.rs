//! Cuts through the bone that was found: their paths, for navigation, and how clear they keep of what must not be sawn.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
/// A cut through the bone of a segment, in the frame of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CutPathDocument {
    pub cut: String,
    pub segment: String,
    /// From below to above the cut, of length 1.
    pub normal: Triple,
    /// Of bone that is sawn.
    pub area_mm2: f64,
    /// Outlines of the bone on the plane of the cut, each in its order and closed; of holes in the bone too.
    pub paths_mm: Vec<Vec<Triple>>,
    /// From each of the structures that were named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clearances: Vec<ClearanceDocument>,
}

/// How far the saw is from a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ClearanceDocument {
    /// Its name.
    pub risk: String,
    /// From the saw to the structure with its radius; negative where the saw enters it.
    pub distance_mm: f64,
    /// What was asked for.
    pub clearance_mm: f64,
    /// The place of its line that is nearest.
    pub at_mm: Triple,
}
