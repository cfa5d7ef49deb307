//! The comparison of a predicted with an actual surface: align, measure both ways, by region.
//!
//! The prediction stays where it is, in the frame of the case, and so do regions and masks; the actual
//! surface is what an alignment moves.

use std::collections::BTreeMap;

use super::alignment::{Aligned, Alignment, AlignmentReport, LandmarkPair, aligned};
use super::both_ways::{BothDirections, Coverage, Pair};
use super::correspondence::corresponding_points;
use super::distance::signed_distances;
use super::error::ComparisonError;
use super::histogram::{Histograms, histograms};
use super::inverse_distance::inverse_distance_map;
use super::landmark_errors::{LandmarkError, landmark_errors};
use super::region::{MovedSurface, Region, region_statistics};
use super::statistics::Statistics;
use super::suspicion;
use super::warped::{WarpedStatistics, warped};
use crate::mesh::{TriangleSurface, Vector, Warning};
use crate::progress::Progress;

/// Input of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonSettings {
    pub alignment: Alignment,
    /// Measures before the alignment too.
    pub report_unaligned: bool,
    /// Named parts in the frame of the prediction.
    pub regions: BTreeMap<String, Region>,
    pub samples_per_mm2: f64,
    pub node_wise: NodeWise,
    /// The same places on both surfaces, the actual ones before the alignment.
    pub landmarks: BTreeMap<String, LandmarkPair>,
    /// Ascending edges of the bins of histograms, in mm; none are made without.
    pub histogram_edges: Vec<f64>,
    /// How far each point of the prediction was moved, in mm, where that is known.
    pub displacement: Option<Vec<Vector>>,
}

impl Default for ComparisonSettings {
    fn default() -> Self {
        ComparisonSettings {
            alignment: Alignment::None,
            report_unaligned: true,
            regions: BTreeMap::new(),
            samples_per_mm2: 1.0,
            node_wise: NodeWise::Auto,
            landmarks: BTreeMap::new(),
            histogram_edges: Vec::new(),
            displacement: None,
        }
    }
}

/// Whether distances between corresponding points are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeWise {
    /// Where node numbers or triangles agree.
    Auto,
    /// The comparison fails where they do not.
    On,
    Off,
}

/// Distances between corresponding points in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeWiseStatistics {
    /// Every point counts the same.
    pub nodes: Statistics,
    /// Every point counts by its area on the prediction.
    pub area: Statistics,
}

/// All that a comparison says. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub distances: BothDirections,
    /// The same before the alignment.
    pub unaligned: Option<BothDirections>,
    pub regions: BTreeMap<String, BothDirections>,
    pub alignment: AlignmentReport,
    pub coverage: Coverage,
    pub node_wise: Option<NodeWiseStatistics>,
    /// By thin-plate spline and closest point; absent where the landmarks do not allow it.
    pub warped: Option<WarpedStatistics>,
    /// At each point of the prediction: the distance to its corresponding point, where there are such.
    pub node_errors: Option<Vec<f64>>,
    /// At each point of the prediction: the distances of the landmarks, by inverse distance; none without landmarks.
    pub landmark_map: Option<Vec<f64>>,
    pub landmark_errors: BTreeMap<String, LandmarkError>,
    pub histograms: Option<Histograms>,
    /// At each point of the prediction; positive where it lies outside the actual surface.
    pub signed_distance: Vec<f64>,
    /// The actual surface where the alignment put it.
    pub aligned_actual: TriangleSurface,
    pub warnings: Vec<Warning>,
}

/// Aligns the actual surface to the prediction as asked, and measures.
pub fn compare(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    settings: &ComparisonSettings,
    progress: &dyn Progress,
) -> Result<Comparison, ComparisonError> {
    // 1. Both surfaces can be searched.
    let pair = Pair::new(prediction, actual)?;
    let mut warnings = Vec::new();

    // 2. The actual surface goes onto the prediction.
    let aligned = aligned(prediction, actual, &settings.alignment, progress)?;
    let Aligned { surface: aligned_actual, report: alignment, warnings: told } = aligned;
    warnings.extend(told);
    let is_moved = settings.alignment != Alignment::None;

    // 3. Distances as they were, and as they are.
    let density = settings.samples_per_mm2;
    let unaligned = if is_moved && settings.report_unaligned {
        Some(pair.measure(density, progress)?.statistics()?)
    } else {
        None
    };
    let pair = if is_moved { Pair::new(prediction, &aligned_actual)? } else { pair };
    let measured = pair.measure(density, progress)?;

    // 4. By region, where both are there, and point by point.
    let moved =
        MovedSurface { surface: prediction, displacement: settings.displacement.as_deref() };
    let regions = region_statistics(moved, &measured, &settings.regions, &mut warnings)?;
    let coverage = measured.coverage(&mut warnings)?;
    let node_errors = node_errors(prediction, &aligned_actual, settings.node_wise)?;
    let of_nodes = node_errors.as_deref().map(|errors| node_wise(prediction, errors));
    let node_wise = of_nodes.transpose()?;
    let transform = &alignment.transform;
    let landmarks = landmark_errors(&settings.landmarks, transform);
    let landmark_map =
        inverse_distance_map(&at_landmarks(settings, &landmarks), &prediction.points);
    let warped = warped(&pair, &settings.landmarks, transform, &mut warnings)?;

    // 5. Whether this is the scan that is meant.
    let distances = measured.statistics()?;
    warnings.extend(suspicion::facing_inwards(&pair));
    warnings.extend(suspicion::apart(&alignment, &distances));
    warnings.extend(suspicion::another_person(&alignment, &distances));
    warnings.extend(suspicion::before_operation(&moved, &aligned_actual)?);
    Ok(Comparison {
        distances,
        unaligned,
        regions,
        alignment,
        coverage,
        node_wise,
        warped,
        node_errors,
        landmark_map,
        landmark_errors: landmarks,
        histograms: histograms(&measured, &settings.histogram_edges),
        signed_distance: signed_distances(&prediction.points, &pair.actual_search),
        aligned_actual,
        warnings,
    })
}

/// Where the prediction has the landmarks, and how far off each is.
fn at_landmarks(
    settings: &ComparisonSettings,
    errors: &BTreeMap<String, LandmarkError>,
) -> Vec<(Vector, f64)> {
    let pairs = settings.landmarks.iter();
    pairs.filter_map(|(name, pair)| Some((pair.prediction, errors.get(name)?.distance))).collect()
}

/// Distances between corresponding points.
fn node_errors(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    wanted: NodeWise,
) -> Result<Option<Vec<f64>>, ComparisonError> {
    if wanted == NodeWise::Off {
        return Ok(None);
    }
    let Some(pairs) = corresponding_points(prediction, actual) else {
        return match wanted {
            NodeWise::On => Err(ComparisonError::NotCorresponding {
                prediction: prediction.points.len(),
                actual: actual.points.len(),
            }),
            NodeWise::Auto | NodeWise::Off => Ok(None),
        };
    };
    let points = prediction.points.iter().zip(pairs);
    Ok(Some(points.map(|(point, other)| (point - actual.points[other]).norm()).collect()))
}

fn node_wise(
    prediction: &TriangleSurface,
    errors: &[f64],
) -> Result<NodeWiseStatistics, ComparisonError> {
    Ok(NodeWiseStatistics {
        nodes: Statistics::plain(errors)?,
        area: Statistics::weighted(errors, &prediction.point_areas())?,
    })
}
