//! Regions of a comparison: spheres and boxes, parts of the skin, and the part that a plan moves.

use std::collections::BTreeMap;

use super::both_ways::{BothDirections, MeasuredPair};
use super::distance::Measured;
use super::error::ComparisonError;
use crate::mesh::{TriangleSurface, Vector, Warning};
use crate::registration::SphereOrBox;

/// Where a comparison is measured once more.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// A part of space in the frame of the prediction.
    SphereOrBox(SphereOrBox),
    /// Triangles of the prediction all of whose corners are among these points, and what is nearest to them.
    Points(Vec<u32>),
    /// Triangles of the prediction whose corners were moved by more than this in the mean, in mm, and what
    /// is nearest to them.
    MovedByMoreThan(f64),
}

/// A region on the triangles of a prediction.
enum Part {
    SphereOrBox(SphereOrBox),
    Triangles(Vec<bool>),
}

impl Part {
    fn holds(&self, measured: &Measured) -> bool {
        match self {
            Part::SphereOrBox(place) => place.holds(&measured.point),
            Part::Triangles(belongs) => belongs[measured.triangle as usize],
        }
    }
}

/// The predicted surface and how far each of its points was moved, where that is known.
#[derive(Clone, Copy)]
pub(super) struct MovedSurface<'a> {
    pub surface: &'a TriangleSurface,
    pub displacement: Option<&'a [Vector]>,
}

impl MovedSurface<'_> {
    /// How far each triangle's corners were moved in the mean, in mm.
    pub fn moved_by(&self) -> Option<Vec<f64>> {
        let displacement = self.displacement?;
        if displacement.len() != self.surface.points.len() {
            return None;
        }
        let length = |point: u32| displacement[point as usize].norm();
        let mean = |corners: &[u32; 3]| corners.iter().map(|&point| length(point)).sum::<f64>();
        Some(self.surface.triangles.iter().map(|corners| mean(corners) / 3.0).collect())
    }

    fn part(&self, name: &str, region: &Region) -> Result<Part, ComparisonError> {
        match region {
            Region::SphereOrBox(place) => Ok(Part::SphereOrBox(*place)),
            Region::Points(points) => {
                let mut is_in = vec![false; self.surface.points.len()];
                points.iter().for_each(|&point| is_in[point as usize] = true);
                let belongs = |corners: &[u32; 3]| corners.iter().all(|&c| is_in[c as usize]);
                Ok(Part::Triangles(self.surface.triangles.iter().map(belongs).collect()))
            }
            Region::MovedByMoreThan(limit) => {
                let missing = || ComparisonError::NoDisplacement { region: name.to_owned() };
                let moved_by = self.moved_by().ok_or_else(missing)?;
                Ok(Part::Triangles(moved_by.into_iter().map(|length| length > *limit).collect()))
            }
        }
    }
}

/// A region without any of the prediction is a mistake; one that the scan does not reach is left out.
pub(super) fn region_statistics(
    prediction: MovedSurface,
    measured: &MeasuredPair,
    regions: &BTreeMap<String, Region>,
    warnings: &mut Vec<Warning>,
) -> Result<BTreeMap<String, BothDirections>, ComparisonError> {
    let mut statistics = BTreeMap::new();
    for (name, region) in regions {
        let part = prediction.part(name, region)?;
        let part = measured.part(|measured| part.holds(measured));
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
