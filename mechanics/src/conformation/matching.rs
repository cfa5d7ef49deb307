//! Matches between a sheet of the template as it lies and a surface of the patient, in both directions.
//!
//! A match does not count where the normals disagree, where it is farther than three robust standard deviations
//! (1.4826 median) and than a limit that shrinks with the lattice, or where it lies on the open border of the other surface: what has no partner follows. Only
//! what lies on the rim of the sheet may meet that border, and is then drawn straight to it.

use rayon::prelude::*;

use super::pull::Pull;
use super::sheet::Sheet;
use crate::mesh::{SearchError, SurfaceSearch, TriangleSurface, Vector, area_sampling};

/// Samples of the patient's surface.
const SAMPLES: usize = 4000;

/// Below this the cosine between normals is that of another part of the face.
const LEAST_COSINE: f64 = 0.5;

/// A surface of the patient, to be matched.
pub(super) struct Target {
    search: SurfaceSearch,
    samples: Vec<(Vector, Vector)>,
    /// Both sides of a bone's surface may be tissue's.
    two_sided: bool,
}

/// What matches weigh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MatchWeights {
    /// Of the whole sheet along the normals.
    pub along: f64,
    /// Share of it across.
    pub across: f64,
    /// In mm: a distance below which every match counts.
    pub always: f64,
    /// Share of the patient's points beside the template's.
    pub back: f64,
}

/// In mm: points nearer than this have no direction between them.
const SAME_PLACE: f64 = 1e-6;

struct Match {
    at: Vector,
    to: Vector,
    normal: Vector,
    distance: f64,
    weight: f64,
}

impl Target {
    pub fn new(search: SurfaceSearch, surface: &TriangleSurface, two_sided: bool) -> Target {
        let samples = area_sampling::equal_areas(surface, SAMPLES);
        let samples = samples
            .iter()
            .map(|sample| {
                let normal = surface.area_vector(sample.triangle as usize);
                (
                    sample.point,
                    normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::zeros),
                )
            })
            .collect();
        Target { search, samples, two_sided }
    }

    /// The pulls on the points of `rest`, which now lie at `now`.
    pub fn pulls(
        &self,
        rest: &Sheet,
        now: &TriangleSurface,
        weights: &MatchWeights,
    ) -> Result<Vec<Pull>, SearchError> {
        let mut matches = self.forth(rest, now);
        trim(&mut matches, weights.always);
        let mut pulls = pulls_of(&matches, weights, 1.0 - weights.back);
        if weights.back > 0.0 {
            let mut matches = self.back(rest, now)?;
            trim(&mut matches, weights.always);
            pulls.extend(pulls_of(&matches, weights, weights.back));
        }
        Ok(pulls)
    }

    /// How many nodes of a sheet lie opposite the surface with a normal like theirs, of how many.
    pub fn partners(&self, now: &TriangleSurface) -> [usize; 2] {
        let normals = now.point_normals();
        let points = now.points.iter().zip(&normals);
        let has_partner = |(point, normal): &(&Vector, &Vector)| {
            let closest = self.search.closest(point);
            !self.search.is_on_open_border(&closest)
                && self.agree(&self.search.pseudo_normal(&closest), normal)
        };
        [points.filter(has_partner).count(), now.points.len()]
    }

    /// Distances of points to the surface, in mm.
    pub fn distances(&self, points: &[Vector]) -> Vec<f64> {
        points.par_iter().map(|point| self.search.closest(point).distance).collect()
    }

    fn agree(&self, one: &Vector, other: &Vector) -> bool {
        let cosine = one.dot(other);
        cosine > LEAST_COSINE || (self.two_sided && cosine < -LEAST_COSINE)
    }

    /// From each node to the nearest point of the patient.
    fn forth(&self, rest: &Sheet, now: &TriangleSurface) -> Vec<Match> {
        let (normals, areas) = (now.point_normals(), now.point_areas());
        let points = (0..now.points.len()).into_par_iter().with_min_len(64);
        let found = points.filter_map(|point| {
            let closest = self.search.closest(&now.points[point]);
            let normal = self.search.pseudo_normal(&closest);
            if !self.agree(&normal, &normals[point]) {
                return None;
            }
            let direction = match self.search.is_on_open_border(&closest) {
                false => normal,
                true if rest.is_rim[point] => {
                    (now.points[point] - closest.point).try_normalize(SAME_PLACE).unwrap_or(normal)
                }
                true => return None,
            };
            Some(Match {
                at: rest.surface.points[point],
                to: closest.point,
                normal: direction,
                distance: closest.distance,
                weight: areas[point],
            })
        });
        found.collect()
    }

    /// From samples of the patient to the nearest points of the template.
    fn back(&self, rest: &Sheet, now: &TriangleSurface) -> Result<Vec<Match>, SearchError> {
        let search = SurfaceSearch::new(now)?;
        let found = self.samples.par_iter().with_min_len(64).filter_map(|(point, normal)| {
            let closest = search.closest(point);
            let here = search.pseudo_normal(&closest);
            let counts = !search.is_on_open_border(&closest) && self.agree(normal, &here);
            let corners = rest.surface.corners(closest.triangle);
            let at = corners.iter().zip(closest.barycentric).map(|(x, w)| x * w).sum();
            let distance = closest.distance;
            counts.then_some(Match { at, to: *point, normal: *normal, distance, weight: 1.0 })
        });
        Ok(found.collect())
    }
}

fn trim(matches: &mut Vec<Match>, always: f64) {
    let mut distances: Vec<f64> = matches.iter().map(|one| one.distance).collect();
    if distances.is_empty() {
        return;
    }
    let middle = distances.len() / 2;
    let median = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
    let limit = (3.0 * 1.4826 * median).max(always);
    matches.retain(|one| one.distance <= limit);
}

fn pulls_of(matches: &[Match], weights: &MatchWeights, share: f64) -> Vec<Pull> {
    let total: f64 = matches.iter().map(|one| one.weight).sum();
    let pull = |one: &Match| {
        let weight = weights.along * share * one.weight / total;
        Pull {
            at: one.at,
            to: one.to,
            normal: one.normal,
            along: weight,
            across: weight * weights.across,
        }
    };
    matches.iter().map(pull).collect()
}
