//! Reasons why two surfaces could not be compared.

use super::distance::DistanceError;
use super::statistics::StatisticsError;
use crate::mesh::SearchError;
use crate::registration::AlignmentError;

/// Why two surfaces cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ComparisonError {
    #[error("the {which} surface cannot be measured: {source}")]
    Surface { which: &'static str, source: SearchError },
    #[error("the actual surface cannot be aligned: {0}")]
    Alignment(AlignmentError),
    #[error(
        "landmark pair {pair} lies {distance:.1} mm outside the box around the {which} surface"
    )]
    LandmarkOutside { which: &'static str, pair: usize, distance: f64 },
    #[error("region `{name}` holds no part of the prediction")]
    EmptyRegion { name: String },
    #[error(
        "region `{region}` is where the skin moved, and the prediction has no point array `displacement_mm`"
    )]
    NoDisplacement { region: String },
    #[error(
        "the surfaces do not correspond: {prediction} and {actual} points, neither node numbers nor triangles agree"
    )]
    NotCorresponding { prediction: usize, actual: usize },
    #[error("{samples:.3e} samples are wanted on one surface, at most {allowed:.0e} are allowed")]
    TooManySamples { samples: f64, allowed: f64 },
    #[error("no statistics: {0}")]
    Statistics(#[from] StatisticsError),
    #[error("cancelled")]
    Cancelled,
}

impl ComparisonError {
    /// A stable name for clients.
    pub fn code(&self) -> &'static str {
        match self {
            ComparisonError::Surface { source: SearchError::NoArea { .. }, .. } => "mesh-empty",
            ComparisonError::Surface { source: SearchError::NotFinite { .. }, .. } => {
                "mesh-nonfinite"
            }
            ComparisonError::Surface { source: SearchError::PointOutOfRange { .. }, .. } => {
                "mesh-index-out-of-range"
            }
            ComparisonError::Alignment(_) | ComparisonError::LandmarkOutside { .. } => {
                "alignment-failed"
            }
            ComparisonError::EmptyRegion { .. } => "empty-region",
            ComparisonError::NoDisplacement { .. } => "no-displacement",
            ComparisonError::NotCorresponding { .. } => "not-corresponding",
            ComparisonError::TooManySamples { .. } => "too-many-samples",
            ComparisonError::Statistics(_) => "mesh-degenerate",
            ComparisonError::Cancelled => "cancelled",
        }
    }
}

impl From<DistanceError> for ComparisonError {
    fn from(error: DistanceError) -> Self {
        match error {
            DistanceError::TooManySamples { samples, allowed } => {
                ComparisonError::TooManySamples { samples, allowed }
            }
            DistanceError::Cancelled => ComparisonError::Cancelled,
        }
    }
}

impl From<AlignmentError> for ComparisonError {
    fn from(error: AlignmentError) -> Self {
        match error {
            AlignmentError::Cancelled { .. } => ComparisonError::Cancelled,
            other => ComparisonError::Alignment(other),
        }
    }
}
