//! Iterative closest point of one surface onto another, point to plane, with a mask.
//!
//! x_i: points spread over the fixed surface, inside the mask; y_i: the closest point to each on the
//! moving surface as it lies, n_i the normal there. Each iteration minimises over a small turn ω about
//! the middle c and a shift t
//!
//!   Σ (n_i · (y_i + ω × (y_i - c) + t - x_i))²
//!
//! until the mean squared distance changes by less than a given share of itself.
//! Pairs farther apart than three robust standard deviations (1.4826 median) and pairs on an open
//! border of the moving surface do not count. Where such a step makes the distance larger, the step of
//! least squares between the points (Kabsch) is taken instead, which cannot.
//!
//! Source: Besl, McKay, IEEE Transactions on Pattern Analysis and Machine Intelligence 14 (1992) 239
//! (the iteration and its stop rule); Chen, Medioni, Image and Vision Computing 10 (1992) 145 (point to
//! plane). It finds the nearest minimum: shapes turned by more than about 30 degrees, or a mask
//! without features, need landmarks first.

use nalgebra::{Matrix6, Rotation3, Vector6};
use rayon::prelude::*;

use super::{AlignmentError, Place, RigidTransform, align_points};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, area_sampling};

/// Points of the fixed surface: few to come near, many to end.
const COARSE_POINTS: usize = 1000;
const FINE_POINTS: usize = 10_000;

/// The coarse points only have to bring the surfaces near.
const COARSE_CHANGE: f64 = 1e-3;
const COARSE_ITERATIONS: usize = 60;

/// Pairs needed for six unknowns with something to spare.
const FEWEST_PAIRS: usize = 12;

/// Directions in which the surfaces slide along each other are left alone: their share of the
/// stiffest direction is rounding.
const FREE_DIRECTION: f64 = 1e-9;

/// Distances below this share of the size of the surface are rounding.
const ROUNDING: f64 = 1e-11;

/// How surfaces are aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterativeClosestPoint {
    /// Only the part of the fixed surface in it decides.
    pub mask: Option<Place>,
    /// The iteration ends when the mean squared distance changes by less than this share.
    pub relative_change: f64,
    pub max_iterations: usize,
}

impl Default for IterativeClosestPoint {
    fn default() -> Self {
        IterativeClosestPoint { mask: None, relative_change: 1e-6, max_iterations: 200 }
    }
}

/// Where the moving surface goes, and how the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAlignment {
    pub transform: RigidTransform,
    pub iterations: usize,
    /// Root of the mean squared distance of the pairs that counted, in mm.
    pub rms: f64,
    /// Points of the fixed surface, and how many of them counted in the end.
    pub points: usize,
    pub pairs: usize,
}

/// A point of the fixed surface, and the closest one of the moving surface as it lies.
struct Pair {
    fixed: Vector,
    moving: Vector,
    normal: Vector,
}

impl Pair {
    fn squared_distance(&self) -> f64 {
        (self.moving - self.fixed).norm_squared()
    }
}

/// When an iteration ends.
pub(super) struct StopRule {
    pub relative_change: f64,
    pub max_iterations: usize,
}

/// The state of an iteration when it ended.
pub(super) struct Ended {
    pub alignment: SurfaceAlignment,
    /// The last relative change of the mean squared distance.
    pub change: f64,
    pub has_converged: bool,
}

impl IterativeClosestPoint {
    /// Moves `moving` onto `fixed`. Surfaces whose boxes do not touch start with their middles together.
    pub fn align(
        &self,
        fixed: &TriangleSurface,
        moving: &TriangleSurface,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<SurfaceAlignment, AlignmentError> {
        let search = SurfaceSearch::new(moving)?;
        let start = starting_transform(fixed, moving);
        let coarse = StopRule { relative_change: COARSE_CHANGE, max_iterations: COARSE_ITERATIONS };
        let points = points_in_mask(fixed, self.mask.as_ref(), COARSE_POINTS)?;
        let near = iterate(&points, &search, start, &coarse, cancelled)?.alignment;
        let fine =
            StopRule { relative_change: self.relative_change, max_iterations: self.max_iterations };
        let points = points_in_mask(fixed, self.mask.as_ref(), FINE_POINTS)?;
        let ended = iterate(&points, &search, near.transform, &fine, cancelled)?;
        let iterations = near.iterations + ended.alignment.iterations;
        if !ended.has_converged {
            return Err(AlignmentError::NotConverged {
                iterations,
                change: ended.change,
                wanted: self.relative_change,
            });
        }
        Ok(SurfaceAlignment { iterations, ..ended.alignment })
    }
}

/// About `count` points spread over the part of a surface in the mask.
pub(super) fn points_in_mask(
    surface: &TriangleSurface,
    mask: Option<&Place>,
    count: usize,
) -> Result<Vec<Vector>, AlignmentError> {
    /// Small masks are found on a denser sampling, up to this many times as dense.
    const DENSER: usize = 64;
    let mut total = count;
    loop {
        let samples = area_sampling::equal_areas(surface, total);
        let points: Vec<Vector> = samples
            .into_iter()
            .map(|sample| sample.point)
            .filter(|point| mask.is_none_or(|mask| mask.holds(point)))
            .collect();
        if 2 * points.len() >= count || total >= count * DENSER {
            return if points.is_empty() { Err(AlignmentError::EmptyMask) } else { Ok(points) };
        }
        let missing = count.div_ceil(points.len().max(1)).clamp(2, 8);
        total = (total * missing).min(count * DENSER);
    }
}

pub(super) fn iterate(
    points: &[Vector],
    search: &SurfaceSearch,
    start: RigidTransform,
    stop: &StopRule,
    cancelled: &dyn Fn() -> bool,
) -> Result<Ended, AlignmentError> {
    let size = middle_and_radius(points).1;
    let mut transform = start;
    let mut last: Option<(RigidTransform, Vec<Pair>, f64)> = None;
    let mut iterations = 0;
    loop {
        if cancelled() {
            return Err(AlignmentError::Cancelled { iterations });
        }
        let pairs = trimmed(pairs_of(points, search, &transform));
        if pairs.len() < FEWEST_PAIRS {
            return Err(AlignmentError::NoOverlap { pairs: pairs.len(), points: points.len() });
        }
        let squared_distance =
            pairs.iter().map(Pair::squared_distance).sum::<f64>() / pairs.len() as f64;
        let before = last.as_ref().map_or(f64::INFINITY, |(_, _, before)| *before);
        let change = (squared_distance - before).abs() / before;
        let has_converged =
            change <= stop.relative_change || squared_distance <= (ROUNDING * size).powi(2);
        if has_converged || iterations == stop.max_iterations {
            let alignment = SurfaceAlignment {
                transform,
                iterations,
                rms: squared_distance.sqrt(),
                points: points.len(),
                pairs: pairs.len(),
            };
            return Ok(Ended { alignment, change, has_converged });
        }
        iterations += 1;
        if let Some((origin, former, _)) = last.take_if(|_| squared_distance > before) {
            transform = origin.then(&point_to_point(&former)?);
        } else {
            let next = transform.then(&point_to_plane(&pairs));
            last = Some((transform, pairs, squared_distance));
            transform = next;
        }
    }
}

/// The closest points, in the order of `points`, without those on an open border.
fn pairs_of(points: &[Vector], search: &SurfaceSearch, transform: &RigidTransform) -> Vec<Pair> {
    let back = transform.inverse();
    let pairs: Vec<Option<Pair>> = points
        .par_iter()
        .with_min_len(64)
        .map(|fixed| {
            let closest = search.closest(&back.apply(fixed));
            (!search.is_on_open_border(&closest)).then(|| Pair {
                fixed: *fixed,
                moving: transform.apply(&closest.point),
                normal: transform.rotation * search.pseudo_normal(&closest),
            })
        })
        .collect();
    pairs.into_iter().flatten().collect()
}

/// The pairs that are not much farther apart than half of them are.
fn trimmed(mut pairs: Vec<Pair>) -> Vec<Pair> {
    if pairs.is_empty() {
        return pairs;
    }
    let mut squares: Vec<f64> = pairs.iter().map(Pair::squared_distance).collect();
    let middle = squares.len() / 2;
    let median_square = *squares.select_nth_unstable_by(middle, f64::total_cmp).1;
    let limit = (3.0 * 1.4826_f64).powi(2) * median_square;
    pairs.retain(|pair| pair.squared_distance() <= limit);
    pairs
}

fn point_to_point(pairs: &[Pair]) -> Result<RigidTransform, AlignmentError> {
    let (moving, fixed): (Vec<Vector>, Vec<Vector>) =
        pairs.iter().map(|pair| (pair.moving, pair.fixed)).unzip();
    Ok(align_points(&moving, &fixed)?.transform)
}

/// The small turn and shift that minimise the distances along the normals.
fn point_to_plane(pairs: &[Pair]) -> RigidTransform {
    let moving: Vec<Vector> = pairs.iter().map(|pair| pair.moving).collect();
    let (centre, radius) = middle_and_radius(&moving);
    let mut matrix = Matrix6::zeros();
    let mut right = Vector6::zeros();
    for pair in pairs {
        // The turn is measured by the shift it causes at `radius`, so that all unknowns are lengths.
        let turn = ((pair.moving - centre) / radius).cross(&pair.normal);
        let normal = pair.normal;
        let row = Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z);
        matrix += row * row.transpose();
        right += row * normal.dot(&(pair.fixed - pair.moving));
    }
    let modes = matrix.symmetric_eigen();
    let stiffest = modes.eigenvalues.amax();
    let mut solution = Vector6::zeros();
    for (value, mode) in modes.eigenvalues.iter().zip(modes.eigenvectors.column_iter()) {
        if *value > FREE_DIRECTION * stiffest {
            solution += mode * (mode.dot(&right) / value);
        }
    }
    let turn = Vector::new(solution[0], solution[1], solution[2]) / radius;
    let shift = Vector::new(solution[3], solution[4], solution[5]);
    RigidTransform::about(&centre, *Rotation3::new(turn).matrix(), shift)
}

/// The mean of some points, and the root of their mean squared distance from it.
fn middle_and_radius(points: &[Vector]) -> (Vector, f64) {
    let count = points.len() as f64;
    // Relative to one of them, so that points far from the origin keep their digits.
    let offsets = points.iter().map(|point| point - points[0]);
    let middle = points[0] + offsets.sum::<Vector>() / count;
    let squares = points.iter().map(|point| (point - middle).norm_squared());
    (middle, (squares.sum::<f64>() / count).sqrt().max(f64::MIN_POSITIVE))
}

/// None, or where the boxes around the surfaces do not touch, the shift that joins their middles.
fn starting_transform(fixed: &TriangleSurface, moving: &TriangleSurface) -> RigidTransform {
    let [(low, high), (moving_low, moving_high)] = [fixed, moving].map(TriangleSurface::bounds);
    let touches =
        (0..3).all(|axis| low[axis] <= moving_high[axis] && moving_low[axis] <= high[axis]);
    let mut start = RigidTransform::identity();
    if !touches {
        start.translation = (low + high - moving_low - moving_high) * 0.5;
    }
    start
}
