//! The answer of a comparison: distances both ways, aligned and as they were, per region.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::Matrix4x4;

/// Statistics of lengths in mm. A percentile is the smallest value whose cumulative weight reaches it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StatDocument {
    pub count: u64,
    pub mean: f64,
    pub sd: f64,
    pub rms: f64,
    pub median: f64,
    pub p90: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
}

/// Statistics of unsigned distances in mm, weighted by area, and of the signed ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DistanceDocument {
    pub count: u64,
    pub mean: f64,
    pub sd: f64,
    pub rms: f64,
    pub median: f64,
    pub p90: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
    /// The largest distance at any point of the surface, in mm.
    pub hausdorff: f64,
    /// Share of the area, 0 to 1.
    pub share_below_1_mm: f64,
    pub share_below_2_mm: f64,
    pub share_below_3_mm: f64,
    /// Positive where the prediction is outside.
    pub signed: StatDocument,
}

/// Distances from the prediction to the actual surface, back, and of both pooled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DirectionsDocument {
    pub to_actual: DistanceDocument,
    pub to_prediction: DistanceDocument,
    pub both: DistanceDocument,
}

/// A comparison of two surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparisonDocument {
    pub to_actual: DistanceDocument,
    pub to_prediction: DistanceDocument,
    pub both: DistanceDocument,
    /// By the names of `regions`; a region without any sample is left out, with a warning.
    pub regions: BTreeMap<String, DirectionsDocument>,
    pub alignment: AlignmentDocument,
    /// The measures before the alignment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unaligned: Option<DirectionsDocument>,
    /// Distances between points of the same number; absent where the surfaces do not correspond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub node_wise: Option<StatDocument>,
    pub samples_per_mm2: f64,
}

/// The rigid movement that took the prediction onto the actual surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AlignmentDocument {
    /// `none` or `icp`.
    pub method: String,
    /// Row-major; x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub iterations: u64,
    /// Root of the mean squared distance of the points that decided the alignment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rms_mm: Option<f64>,
}
