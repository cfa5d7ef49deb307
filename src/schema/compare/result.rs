//! The result of a comparison: distances both ways, before and after alignment, per region.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::measures::{
    HistogramsDocument, LandmarkErrorDocument, WarpedDocument, landmark_statistics,
};
pub use super::statistics::StatDocument;
use crate::schema::case::acquisition::AcquisitionDocument;
use crate::schema::{Matrix4x4, Triple};
use mechanics::registration::StandardError;
use mechanics::validation::{AlignmentReport, BothDirections, Comparison, DistanceStatistics};

/// Statistics of unsigned distances in mm, weighted by area, and of the signed ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DistanceDocument {
    pub count: u64,
    pub mean: f64,
    pub sd: f64,
    pub rms: f64,
    #[serde(default)]
    pub min: f64,
    #[serde(default)]
    pub p25: f64,
    pub median: f64,
    #[serde(default)]
    pub p75: f64,
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
    /// Positive if the prediction is outside.
    pub signed: StatDocument,
}

/// Distances from the prediction to the actual surface, back, and of both pooled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DirectionsDocument {
    pub to_actual: DistanceDocument,
    pub to_prediction: DistanceDocument,
    pub both: DistanceDocument,
}

/// A comparison of two surfaces. An alignment moves the actual surface, not the prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparisonDocument {
    pub to_actual: DistanceDocument,
    pub to_prediction: DistanceDocument,
    pub both: DistanceDocument,
    /// By the names of `regions`; a region that the actual surface does not cover is omitted, with a warning.
    pub regions: BTreeMap<String, DirectionsDocument>,
    pub alignment: AlignmentDocument,
    /// The measures before the alignment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unaligned: Option<DirectionsDocument>,
    pub coverage: CoverageDocument,
    /// Distances between points with the same index; absent if the surfaces do not correspond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub node_wise: Option<NodeWiseDocument>,
    /// Distances by thin-plate spline and closest point; absent without landmarks that determine a spline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub tps_cp: Option<WarpedDocument>,
    /// By the names of `landmarks`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmark_errors: BTreeMap<String, LandmarkErrorDocument>,
    /// Of these distances, percentiles interpolated between neighbours; absent without landmarks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub landmark_statistics: Option<StatDocument>,
    /// Absent without `histogram_edges_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub histogram: Option<HistogramsDocument>,
    pub samples_per_mm2: f64,
    /// How the actual surface was taken, from the spec.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
}

/// The rigid movement of the actual surface onto the prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AlignmentDocument {
    /// `none`, `matrix`, `landmarks`, `icp` or `surfaces`.
    pub method: String,
    /// Row-major; x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub rotation_deg: f64,
    /// Of the centre of the actual surface.
    pub displacement_mm: Triple,
    pub iterations: u64,
    /// Pairs of points used.
    pub pairs: u64,
    /// Root of the mean squared distance of these pairs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rms_mm: Option<f64>,
    /// Share of the points used that remain more than 1 mm from their partners, 0 to 1; of `icp` and `surfaces`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub share_above_1_mm: Option<f64>,
    /// Of the position of the compared skin, from the shape and residual of the surfaces aligned; of `icp` and `surfaces`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub standard_error: Option<StandardErrorDocument>,
}

/// The standard error of a registration of surfaces; without members if their shape leaves a movement free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StandardErrorDocument {
    /// Of the rotation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rotation_deg: Option<f64>,
    /// The largest of all displacements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub displacement_mm: Option<f64>,
}

impl From<Option<&StandardError>> for StandardErrorDocument {
    fn from(error: Option<&StandardError>) -> Self {
        StandardErrorDocument {
            rotation_deg: error.map(|error| error.rotation.to_degrees()),
            displacement_mm: error.map(|error| error.displacement),
        }
    }
}

/// The share of each surface that the other covers, 0 to 1, and distances of that part alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CoverageDocument {
    pub of_prediction: f64,
    pub of_actual: f64,
    /// Absent if all or nothing is covered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub to_actual: Option<DistanceDocument>,
    /// Absent if all or nothing is covered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub to_prediction: Option<DistanceDocument>,
}

/// Distances in mm between points with the same index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NodeWiseDocument {
    /// Unweighted.
    pub nodes: StatDocument,
    /// Weighted by area on the prediction.
    pub area: StatDocument,
}

impl DistanceDocument {
    /// The statistics of the unsigned distances alone.
    pub fn to_stat(self) -> StatDocument {
        let DistanceDocument { count, mean, sd, rms, min, p25, median, p75, p90, p95, .. } = self;
        let DistanceDocument { p99, max, .. } = self;
        StatDocument { count, mean, sd, rms, min, p25, median, p75, p90, p95, p99, max }
    }
}

impl From<&DistanceStatistics> for DistanceDocument {
    fn from(statistics: &DistanceStatistics) -> Self {
        let StatDocument { count, mean, sd, rms, min, p25, median, p75, p90, p95, p99, max } =
            StatDocument::from(&statistics.unsigned);
        DistanceDocument {
            count,
            mean,
            sd,
            rms,
            min,
            p25,
            median,
            p75,
            p90,
            p95,
            p99,
            max,
            hausdorff: statistics.hausdorff,
            share_below_1_mm: statistics.share_below_1_mm,
            share_below_2_mm: statistics.share_below_2_mm,
            share_below_3_mm: statistics.share_below_3_mm,
            signed: StatDocument::from(&statistics.signed),
        }
    }
}

impl From<&BothDirections> for DirectionsDocument {
    fn from(directions: &BothDirections) -> Self {
        DirectionsDocument {
            to_actual: DistanceDocument::from(&directions.to_actual),
            to_prediction: DistanceDocument::from(&directions.to_prediction),
            both: DistanceDocument::from(&directions.both),
        }
    }
}

impl From<&AlignmentReport> for AlignmentDocument {
    fn from(report: &AlignmentReport) -> Self {
        let (rotation, translation) = (&report.transform.rotation, &report.transform.translation);
        let mut matrix = [0.0; 16];
        for row in 0..3 {
            for column in 0..3 {
                matrix[4 * row + column] = rotation[(row, column)];
            }
            matrix[4 * row + 3] = translation[row];
        }
        matrix[15] = 1.0;
        AlignmentDocument {
            method: report.method.to_owned(),
            matrix4x4: Matrix4x4(matrix),
            rotation_deg: report.angle.to_degrees(),
            displacement_mm: report.middle_displacement.into(),
            iterations: report.iterations as u64,
            pairs: report.pairs as u64,
            rms_mm: report.rms,
            share_above_1_mm: report.share_far,
            standard_error: report
                .share_far
                .map(|_| StandardErrorDocument::from(report.standard_error.as_ref())),
        }
    }
}

impl ComparisonDocument {
    /// The result of a comparison, and its sampling density.
    pub fn new(comparison: &Comparison, samples_per_mm2: f64) -> Self {
        let all = DirectionsDocument::from(&comparison.distances);
        let regions = comparison.regions.iter();
        let coverage = &comparison.coverage;
        ComparisonDocument {
            to_actual: all.to_actual,
            to_prediction: all.to_prediction,
            both: all.both,
            regions: regions.map(|(name, region)| (name.clone(), region.into())).collect(),
            alignment: AlignmentDocument::from(&comparison.alignment),
            unaligned: comparison.unaligned.as_ref().map(DirectionsDocument::from),
            coverage: CoverageDocument {
                of_prediction: coverage.of_prediction,
                of_actual: coverage.of_actual,
                to_actual: coverage.to_actual.as_ref().map(DistanceDocument::from),
                to_prediction: coverage.to_prediction.as_ref().map(DistanceDocument::from),
            },
            node_wise: comparison.node_wise.as_ref().map(|node_wise| NodeWiseDocument {
                nodes: StatDocument::from(&node_wise.nodes),
                area: StatDocument::from(&node_wise.area),
            }),
            tps_cp: comparison.warped.as_ref().map(WarpedDocument::from),
            landmark_errors: comparison
                .landmark_errors
                .iter()
                .map(|(name, error)| (name.clone(), error.into()))
                .collect(),
            landmark_statistics: landmark_statistics(comparison),
            histogram: comparison.histograms.as_ref().map(HistogramsDocument::from),
            samples_per_mm2,
            acquisition: None,
        }
    }
}
