//! Distances from surface to surface, both ways, on points spread over the area.
//!
//! Directed: the integral of d(x, B) over A is the sum over samples x_i that each stand for an area
//! w_i of A. Pooled: (∫_A d(x, B) + ∫_B d(x, A)) / (|A| + |B|), so the samples of both directions in
//! one set. Hausdorff: the largest distance at any sample or vertex; pooled, the larger of both.
//!
//! Source of the pooled measure: Zachow et al. 2006, section 3.2, and Aspert, Santa-Cruz, Ebrahimi, MESH: measuring errors
//! between surfaces using the Hausdorff distance, IEEE International Conference on Multimedia (2002).

use std::ops::Add as _;

use rayon::prelude::*;

use super::statistics::{Statistics, StatisticsError};
use crate::mesh::area_sampling::{self, AreaSample};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::progress::Progress;

/// More samples of one surface are refused.
pub const MAX_SAMPLES: f64 = 2e7;

/// Points that are measured between two looks at whether to stop.
const POINTS_AT_A_TIME: usize = 1 << 16;

/// A point of one surface and its distance from the other, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub point: Vector,
    /// The triangle of the prediction that it lies on or is nearest to.
    pub triangle: u32,
    /// The area that it stands for in mm²; zero for a vertex, which counts for the largest distance only.
    pub area: f64,
    pub distance: f64,
    /// Positive where the prediction lies outside the actual surface.
    pub signed: f64,
    /// The closest point lies on an open border: there is nothing opposite.
    pub is_beyond_border: bool,
}

/// All distances of one surface from another: samples, then vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distances {
    pub measured: Vec<Measured>,
}

/// Statistics of distances in mm, weighted by area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceStatistics {
    pub unsigned: Statistics,
    /// Positive where the prediction lies outside the actual surface.
    pub signed: Statistics,
    /// The largest distance at any sample or vertex.
    pub hausdorff: f64,
    /// Shares of the area, 0 to 1.
    pub share_below_1_mm: f64,
    pub share_below_2_mm: f64,
    pub share_below_3_mm: f64,
    /// The area measured, in mm².
    pub area: f64,
}

/// Why distances could not be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DistanceError {
    #[error("{samples:.3e} samples are wanted on one surface, at most {allowed:.0e} are allowed")]
    TooManySamples { samples: f64, allowed: f64 },
    #[error("cancelled while distances were measured")]
    Cancelled,
}

/// The surface that the distances go to; which of the two it is decides the sign.
#[derive(Clone, Copy)]
pub enum Direction<'a> {
    /// From the prediction to this actual surface.
    ToActual(&'a SurfaceSearch),
    /// From the actual surface to this prediction.
    ToPrediction(&'a SurfaceSearch),
}

/// Refuses more samples of a surface than can be measured, before any is.
pub fn require_possible(from: &TriangleSurface, samples_per_mm2: f64) -> Result<(), DistanceError> {
    let samples = area_sampling::count_of_every_triangle(from, samples_per_mm2);
    match samples <= MAX_SAMPLES {
        true => Ok(()),
        false => Err(DistanceError::TooManySamples { samples, allowed: MAX_SAMPLES }),
    }
}

impl Distances {
    /// From every sample and every used vertex of `from` to the other surface.
    pub fn measure(
        from: &TriangleSurface,
        to: Direction,
        samples_per_mm2: f64,
        progress: &dyn Progress,
    ) -> Result<Self, DistanceError> {
        require_possible(from, samples_per_mm2)?;
        let samples = area_sampling::every_triangle(from, samples_per_mm2);
        let mut places = samples;
        places.extend(used_points(from));
        let mut measured = Vec::with_capacity(places.len());
        for places in places.chunks(POINTS_AT_A_TIME) {
            if progress.is_cancelled() {
                return Err(DistanceError::Cancelled);
            }
            // In the order of the places, whatever the number of threads.
            measured
                .par_extend(places.par_iter().with_min_len(256).map(|place| measure(place, to)));
        }
        Ok(Distances { measured })
    }

    /// Of the points for which `belongs` holds.
    pub fn part(&self, belongs: impl Fn(&Measured) -> bool) -> Distances {
        Distances { measured: self.measured.iter().filter(|m| belongs(m)).copied().collect() }
    }

    /// Both directions as one set.
    pub fn pooled(&self, other: &Distances) -> Distances {
        Distances { measured: [self.measured.as_slice(), &other.measured].concat() }
    }

    /// Whether any sample is left, and not vertices alone.
    pub fn has_area(&self) -> bool {
        self.measured.iter().any(|measured| measured.area > 0.0)
    }

    pub fn statistics(&self) -> Result<DistanceStatistics, StatisticsError> {
        let samples = || self.measured.iter().filter(|measured| measured.area > 0.0);
        let areas: Vec<f64> = samples().map(|measured| measured.area).collect();
        let unsigned: Vec<f64> = samples().map(|measured| measured.distance).collect();
        let signed: Vec<f64> = samples().map(|measured| measured.signed).collect();
        let area: f64 = areas.iter().sum();
        let share_below = |limit: f64| {
            let below = samples().filter(|measured| measured.distance < limit);
            below.map(|measured| measured.area).fold(0.0, f64::add) / area
        };
        Ok(DistanceStatistics {
            unsigned: Statistics::weighted(&unsigned, &areas)?,
            signed: Statistics::weighted(&signed, &areas)?,
            hausdorff: self.measured.iter().map(|measured| measured.distance).fold(0.0, f64::max),
            share_below_1_mm: share_below(1.0),
            share_below_2_mm: share_below(2.0),
            share_below_3_mm: share_below(3.0),
            area,
        })
    }

    /// The share of the area that has something opposite: whose closest point is not on an open border.
    pub fn covered_share(&self) -> f64 {
        let total: f64 = self.measured.iter().map(|measured| measured.area).sum();
        let covered = self.measured.iter().filter(|measured| !measured.is_beyond_border);
        // The sum of nothing is -0.
        covered.fold(0.0, |sum, measured| sum + measured.area) / total
    }
}

/// For each point the signed distance in mm: positive outside the surface that is searched.
pub fn signed_distances(points: &[Vector], to: &SurfaceSearch) -> Vec<f64> {
    points
        .par_iter()
        .with_min_len(256)
        .map(|&point| AreaSample { point, triangle: 0, area: 0.0 })
        .map(|place| measure(&place, Direction::ToActual(to)).signed)
        .collect()
}

fn measure(&AreaSample { point, triangle, area }: &AreaSample, to: Direction) -> Measured {
    let (search, sign) = match to {
        Direction::ToActual(search) => (search, 1.0),
        // Where the actual surface is outside, the prediction is inside.
        Direction::ToPrediction(search) => (search, -1.0),
    };
    let closest = search.closest(&point);
    let outside = search.signed_distance(&point, &closest);
    Measured {
        point,
        triangle: match to {
            Direction::ToActual(_) => triangle,
            Direction::ToPrediction(_) => closest.triangle as u32,
        },
        area,
        distance: closest.distance,
        // Adding zero turns -0 into 0.
        signed: sign * outside + 0.0,
        is_beyond_border: search.is_on_open_border(&closest),
    }
}

/// The points that triangles use, in their order, each with the last of these.
fn used_points(surface: &TriangleSurface) -> impl Iterator<Item = AreaSample> + '_ {
    let mut used_by = vec![None; surface.points.len()];
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        corners.iter().for_each(|&point| used_by[point as usize] = Some(triangle as u32));
    }
    let points = surface.points.iter().zip(used_by);
    points
        .filter_map(|(&point, triangle)| Some(AreaSample { point, triangle: triangle?, area: 0.0 }))
}
