//! The comparison of a predicted with an actual surface: align, measure both ways, by region.
//!
//! The prediction stays where it is, in the frame of the case, and so do regions and masks; the actual
//! surface is what an alignment moves.

use super::alignment::{Alignment, AlignmentReport, align, mirror_warning};
use super::correspondence::corresponding_points;
use super::distance::{
    Direction, DistanceError, DistanceStatistics, Distances, Measured, signed_distances,
};
use super::error::ComparisonError;
use super::statistics::{Statistics, StatisticsError};
use crate::mesh::{SurfaceSearch, TriangleSurface, Warning};
use crate::progress::Progress;
use crate::registration::Place;
use std::collections::BTreeMap;

/// Below this share a scan covers only a part of the prediction, and the reader is told.
const WHOLE: f64 = 0.95;

/// What is compared and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonSettings {
    pub alignment: Alignment,
    /// Measures before the alignment too.
    pub report_unaligned: bool,
    /// Named parts of space in the frame of the prediction.
    pub regions: BTreeMap<String, Place>,
    pub samples_per_mm2: f64,
    pub node_wise: NodeWise,
}

impl Default for ComparisonSettings {
    fn default() -> Self {
        ComparisonSettings {
            alignment: Alignment::None,
            report_unaligned: true,
            regions: BTreeMap::new(),
            samples_per_mm2: 1.0,
            node_wise: NodeWise::Auto,
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

/// Distances from the prediction, from the actual surface, and of both pooled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BothDirections {
    pub to_actual: DistanceStatistics,
    pub to_prediction: DistanceStatistics,
    pub both: DistanceStatistics,
}

/// How much of each surface has the other opposite, and distances of that part alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Share of the prediction's area whose closest point is not on an open border of the actual surface.
    pub of_prediction: f64,
    /// Share of the actual surface's area, the other way round.
    pub of_actual: f64,
    /// From the covered part of the prediction; absent where all or nothing is covered.
    pub to_actual: Option<DistanceStatistics>,
    /// From the covered part of the actual surface; absent where all or nothing is covered.
    pub to_prediction: Option<DistanceStatistics>,
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
    let alignment = align(prediction, actual, &settings.alignment, progress)?;
    warnings.extend(mirror_warning(prediction, actual, &settings.alignment, &alignment));
    let is_moved = settings.alignment != Alignment::None;
    let aligned_actual = if is_moved { moved(actual, &alignment) } else { actual.clone() };

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
    let regions = region_statistics(&measured, &settings.regions, &mut warnings)?;
    let coverage = measured.coverage(&mut warnings)?;
    let node_wise = node_wise(prediction, &aligned_actual, settings.node_wise)?;
    Ok(Comparison {
        distances: measured.statistics()?,
        unaligned,
        regions,
        alignment,
        coverage,
        node_wise,
        signed_distance: signed_distances(&prediction.points, &pair.actual_search),
        aligned_actual,
        warnings,
    })
}

fn moved(surface: &TriangleSurface, alignment: &AlignmentReport) -> TriangleSurface {
    let mut moved = surface.clone();
    for point in &mut moved.points {
        *point = alignment.transform.apply(point);
    }
    moved
}

/// Two surfaces ready to be measured from each other.
struct Pair<'a> {
    prediction: &'a TriangleSurface,
    actual: &'a TriangleSurface,
    prediction_search: SurfaceSearch,
    actual_search: SurfaceSearch,
}

impl<'a> Pair<'a> {
    fn new(
        prediction: &'a TriangleSurface,
        actual: &'a TriangleSurface,
    ) -> Result<Self, ComparisonError> {
        let search = |which: &'static str, surface: &TriangleSurface| {
            SurfaceSearch::new(surface).map_err(|source| ComparisonError::Surface { which, source })
        };
        Ok(Pair {
            prediction,
            actual,
            prediction_search: search("predicted", prediction)?,
            actual_search: search("actual", actual)?,
        })
    }

    fn measure(
        &self,
        density: f64,
        progress: &dyn Progress,
    ) -> Result<MeasuredPair, DistanceError> {
        let to_actual = Direction::ToActual(&self.actual_search);
        let to_prediction = Direction::ToPrediction(&self.prediction_search);
        Ok(MeasuredPair {
            to_actual: Distances::measure(self.prediction, to_actual, density, progress)?,
            to_prediction: Distances::measure(self.actual, to_prediction, density, progress)?,
        })
    }
}

struct MeasuredPair {
    to_actual: Distances,
    to_prediction: Distances,
}

impl MeasuredPair {
    fn statistics(&self) -> Result<BothDirections, StatisticsError> {
        Ok(BothDirections {
            to_actual: self.to_actual.statistics()?,
            to_prediction: self.to_prediction.statistics()?,
            both: self.to_actual.pooled(&self.to_prediction).statistics()?,
        })
    }

    fn part(&self, belongs: impl Fn(&Measured) -> bool) -> MeasuredPair {
        MeasuredPair {
            to_actual: self.to_actual.part(&belongs),
            to_prediction: self.to_prediction.part(&belongs),
        }
    }

    fn coverage(&self, warnings: &mut Vec<Warning>) -> Result<Coverage, StatisticsError> {
        let covered = self.part(|measured| !measured.is_beyond_border);
        let of_part = |share: f64, part: &Distances| match share {
            share if share > 0.0 && share < 1.0 => part.statistics().map(Some),
            _ => Ok(None),
        };
        let of_prediction = self.to_actual.covered_share();
        let of_actual = self.to_prediction.covered_share();
        if of_prediction < WHOLE {
            let percent = of_prediction * 100.0;
            let detail = format!(
                "the actual surface covers {percent:.1} % of the prediction: the rest is measured to its border"
            );
            warnings.push(Warning::new("partial-coverage", detail).with("share", of_prediction));
        }
        Ok(Coverage {
            of_prediction,
            of_actual,
            to_actual: of_part(of_prediction, &covered.to_actual)?,
            to_prediction: of_part(of_actual, &covered.to_prediction)?,
        })
    }
}

/// A region without any of the prediction is a mistake; one that the scan does not reach is left out.
fn region_statistics(
    measured: &MeasuredPair,
    regions: &BTreeMap<String, Place>,
    warnings: &mut Vec<Warning>,
) -> Result<BTreeMap<String, BothDirections>, ComparisonError> {
    let mut statistics = BTreeMap::new();
    for (name, place) in regions {
        let part = measured.part(|measured| place.holds(&measured.point));
        if !part.to_actual.has_area() {
            return Err(ComparisonError::EmptyRegion { name: name.clone() });
        }
        if part.to_prediction.has_area() {
            statistics.insert(name.clone(), part.statistics()?);
        } else {
            let detail = format!("region `{name}` holds no part of the actual surface");
            warnings.push(Warning::new("empty-region", detail));
        }
    }
    Ok(statistics)
}

fn node_wise(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    wanted: NodeWise,
) -> Result<Option<NodeWiseStatistics>, ComparisonError> {
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
    let distances: Vec<f64> = prediction
        .points
        .iter()
        .zip(pairs)
        .map(|(point, other)| (point - actual.points[other]).norm())
        .collect();
    Ok(Some(NodeWiseStatistics {
        nodes: Statistics::plain(&distances)?,
        area: Statistics::weighted(&distances, &prediction.point_areas())?,
    }))
}
