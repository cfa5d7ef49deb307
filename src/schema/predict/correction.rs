//! Correction of a prediction by a model learned from operated cases.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Adds what was learned to the mechanical prediction, which stays as it is beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CorrectionDocument {
    /// The id of a job of kind `learn`; on the command line its folder.
    pub model: String,
}

/// What a model says of a case. Lengths in mm over the points of the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CorrectedDocument {
    pub model: String,
    /// Whether validation found the model nearer to the truth than mechanics alone, and the mean errors of both.
    pub helps: bool,
    pub model_error_mm: f64,
    pub mechanical_error_mm: f64,
    /// Why there is no corrected skin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub refused: Option<String>,
    /// From the nearest case that was learned from, in standardised features; absent where the case is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub distance: Option<f64>,
    /// Beyond it a case is refused: 95 % of those learned from are nearer to each other.
    pub farthest: f64,
    /// The mean length of what was added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub changed_mm: Option<f64>,
    /// The mean width of the band from 10 to 90 % of a component; absent with fewer than 9 cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub band_mm: Option<f64>,
}
