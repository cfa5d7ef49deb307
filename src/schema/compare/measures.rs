//! Measures of a comparison beside closest points: landmarks, thin-plate splines, histograms.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::statistics::StatDocument;
use crate::schema::Triple;
use mechanics::validation::{
    Comparison, Histogram, Histograms, LandmarkError, Statistics, WarpedStatistics,
};

/// Distances in mm from predicted points to the closest actual points of their images under a thin-plate spline through
/// the landmarks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WarpedDocument {
    pub landmarks: u64,
    /// Four landmarks give an affine map only.
    pub is_affine: bool,
    /// Unweighted.
    pub nodes: StatDocument,
    /// Weighted by area on the prediction.
    pub area: StatDocument,
    /// By area; positive if the prediction is outside.
    pub signed: StatDocument,
}

/// A landmark of the prediction relative to that of the aligned actual surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LandmarkErrorDocument {
    pub difference_mm: Triple,
    pub distance_mm: f64,
}

/// Shares of the area of both surfaces, 0 to 1, which add up to 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HistogramDocument {
    /// Below the first edge.
    pub below: f64,
    /// From each edge, inclusive, to the next, exclusive.
    pub shares: Vec<f64>,
    /// At or above the last edge.
    pub above: f64,
}

/// Of the distances of both directions, unsigned and signed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HistogramsDocument {
    pub unsigned: HistogramDocument,
    /// Positive if the prediction is outside.
    pub signed: HistogramDocument,
}

/// Of the distances of landmarks, if there are any.
pub(super) fn landmark_statistics(comparison: &Comparison) -> Option<StatDocument> {
    let errors = comparison.landmark_errors.values();
    let distances: Vec<f64> = errors.map(|error| error.distance).collect();
    Statistics::of_subjects(&distances).ok().as_ref().map(StatDocument::from)
}

impl From<&WarpedStatistics> for WarpedDocument {
    fn from(warped: &WarpedStatistics) -> Self {
        WarpedDocument {
            landmarks: warped.landmarks as u64,
            is_affine: warped.is_affine,
            nodes: StatDocument::from(&warped.nodes),
            area: StatDocument::from(&warped.area),
            signed: StatDocument::from(&warped.signed),
        }
    }
}

impl From<&LandmarkError> for LandmarkErrorDocument {
    fn from(error: &LandmarkError) -> Self {
        LandmarkErrorDocument {
            difference_mm: error.difference.into(),
            distance_mm: error.distance,
        }
    }
}

impl From<&Histogram> for HistogramDocument {
    fn from(histogram: &Histogram) -> Self {
        let Histogram { below, shares, above } = histogram.clone();
        HistogramDocument { below, shares, above }
    }
}

impl From<&Histograms> for HistogramsDocument {
    fn from(histograms: &Histograms) -> Self {
        HistogramsDocument {
            unsigned: (&histograms.unsigned).into(),
            signed: (&histograms.signed).into(),
        }
    }
}
