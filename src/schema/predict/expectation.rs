//! Expected choice of the method `auto`, and its cost.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::time_band::TimeBandDocument;

/// The basis of an expectation.
pub const RESTS_ON: &str = "the size of the movement alone, by a rule of thumb: the discretisation error is unknown before it \
    is solved, and may require a corrected result or exceed the tolerance";

/// The models of `auto`, and the one required by the size of a movement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExpectationDocument {
    /// The accepted mean error over the skin, in mm.
    pub accepted_mm: f64,
    /// The largest movement of a segment relative to another or to fixed nodes, in mm, and the largest rotation.
    pub movement_mm: f64,
    pub rotation_deg: f64,
    /// The expected range of the mean linearisation error over the skin, in mm.
    pub linearity_mm: BandDocument,
    /// The cheapest model at both ends: `linear`, `second_order` or `finite_strain`.
    pub at_least: String,
    pub at_most: String,
    pub rests_on: String,
    /// From the cheapest to the most expensive, tried in this order.
    pub rungs: Vec<ExpectedRungDocument>,
}

/// From the smallest to the largest likely value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BandDocument {
    pub low: f64,
    pub high: f64,
}

/// A model, and its expected cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExpectedRungDocument {
    pub name: String,
    /// Of this model alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub time_s: Option<TimeBandDocument>,
    pub memory_mb: f64,
}
