//! Expected choice of the method `auto`, and its cost.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::time_band::TimeBandDocument;

/// What an expectation rests on.
pub const RESTS_ON: &str = "the size of the movement alone, by a rule of thumb: what the mesh leaves out is not known before it \
    is solved, and may ask for a corrected answer or leave the tolerance unmet";

/// The models of `auto`, and which of them the size of a movement asks for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExpectationDocument {
    /// The mean error over the skin that is accepted, in mm.
    pub accepted_mm: f64,
    /// The largest movement of a segment against another or against what stays, in mm, and the largest rotation.
    pub movement_mm: f64,
    pub rotation_deg: f64,
    /// Between which mean lengths over the skin linearity is expected to leave out, in mm.
    pub linearity_mm: BandDocument,
    /// The cheapest model at both ends: `linear`, `second_order` or `finite_strain`.
    pub at_least: String,
    pub at_most: String,
    pub rests_on: String,
    /// From the cheapest to the dearest; each is tried after those before it.
    pub rungs: Vec<ExpectedRungDocument>,
}

/// From the smallest to the largest that is likely.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BandDocument {
    pub low: f64,
    pub high: f64,
}

/// A model, and what it is expected to take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExpectedRungDocument {
    pub name: String,
    /// Of this model alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub time_s: Option<TimeBandDocument>,
    pub memory_mb: f64,
}
