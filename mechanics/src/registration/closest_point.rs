//! Iterative closest point of one surface onto another, point to plane, with a mask.
//!
//! x_i: points spread over the fixed surface, inside the mask; y_i: the closest point to each on the
//! moving surface as it lies, n_i the direction between them. Each iteration minimises over a small turn
//! ω about the middle c and a shift t
//!
//!   Σ (n_i · (y_i + ω × (y_i - c) + t - x_i))²
//!
//! until the mean squared distance changes by less than a given share of itself.
//! Pairs farther apart than three robust standard deviations (1.4826 median), a limit that shrinks in
//! the first iterations and then stays, and pairs on an open border of the moving surface do not
//! count. A step that does not lower the squared distances cut at the limit is damped and tried again.
//!
//! Source: Besl, McKay, IEEE Transactions on Pattern Analysis and Machine Intelligence 14 (1992) 239
//! (the iteration and its stop rule); Chen, Medioni, Image and Vision Computing 10 (1992) 145 (point to
//! plane); Fitzgibbon, Image and Vision Computing 21 (2003) 1145 (damping). It finds the nearest
//! minimum: shapes turned by more than about 30 degrees, or a mask without features, need landmarks first.

use nalgebra::{Matrix6, Rotation3, Vector6};
use rayon::prelude::*;

use super::masked_points::{places, points_in_mask, samples_in_mask};
use super::uncertainty::{Observation, RigidUncertainty};
use super::{AlignmentError, RigidTransform, SphereOrBox, Start};
use crate::mesh::closest_point::Feature;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::progress::Progress;

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

/// Distances below this share of the largest coordinate are rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Steps after which the limit of what counts stays, so that the distances cannot but fall.
const SHRINKING_STEPS: usize = 20;

/// Three standard deviations of a normal distribution with this median, squared.
const LIMIT_BY_MEDIAN: f64 = 9.0 * 1.4826 * 1.4826;

/// In mm: points nearer than this have no direction between them.
const SAME_PLACE: f64 = 1e-6;

/// In mm: what is left beyond this does not fit.
pub const FAR: f64 = 1.0;

/// Steps in a row that lower the distances by no more than is asked for, however damped, are the end: near the rounding of
/// files undamped steps lower nothing, and damped ones by nothing.
const STILL_STEPS: usize = 4;

/// Damping relative to the mean stiffness: where it starts, and where no step is left.
const FIRST_DAMPING: f64 = 1e-3;
const LAST_DAMPING: f64 = 1e6;

/// How surfaces are aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterativeClosestPoint {
    /// Only the part of the fixed surface in it decides.
    pub mask: Option<SphereOrBox>,
    pub start: Start,
    /// The iteration ends when the mean squared distance changes by less than this share.
    pub relative_change: f64,
    pub max_iterations: usize,
}

impl Default for IterativeClosestPoint {
    fn default() -> Self {
        let start = Start::AsItLies;
        IterativeClosestPoint { mask: None, start, relative_change: 1e-6, max_iterations: 200 }
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
    /// Share of the points with something opposite that are left more than [`FAR`] from it, 0 to 1.
    pub share_far: f64,
    /// Of `transform`; nothing where the shape of what counted leaves a movement free.
    pub uncertainty: Option<RigidUncertainty>,
}

/// A point of the fixed surface, and the closest one of the moving surface as it lies.
#[derive(Clone, Copy)]
struct Pair {
    fixed: Vector,
    moving: Vector,
    /// Between the two, or the normal of the moving surface where they are about the same.
    direction: Vector,
    /// Of the moving surface.
    normal: Vector,
    squared_distance: f64,
}

impl Pair {
    /// Of a pair that stands for an area in mm².
    fn observation(&self, area: f64) -> Observation {
        Observation { point: self.fixed, normal: self.normal, area }
    }
}

/// When an iteration ends.
pub(super) struct StopRule {
    pub relative_change: f64,
    pub max_iterations: usize,
}

/// The state of an iteration when it ended.
pub(super) struct IterationState {
    pub alignment: SurfaceAlignment,
    /// Those that counted.
    pairs: Vec<Pair>,
    /// The last relative change of the mean squared distance.
    pub change: f64,
    pub has_converged: bool,
}

impl IterativeClosestPoint {
    /// Moves `moving` onto `fixed`.
    pub fn align(
        &self,
        fixed: &TriangleSurface,
        moving: &TriangleSurface,
        progress: &dyn Progress,
    ) -> Result<SurfaceAlignment, AlignmentError> {
        let search = SurfaceSearch::new(moving)?;
        let start = self.start.transform(fixed, moving, &search);
        let coarse = StopRule {
            relative_change: COARSE_CHANGE,
            max_iterations: COARSE_ITERATIONS.min(self.max_iterations),
        };
        let points = points_in_mask(fixed, self.mask.as_ref(), COARSE_POINTS)?;
        let near = iterate(&points, &search, start, &coarse, progress)?.alignment;
        let fine =
            StopRule { relative_change: self.relative_change, max_iterations: self.max_iterations };
        let samples = samples_in_mask(fixed, self.mask.as_ref(), FINE_POINTS)?;
        let (piece, points) = (samples[0].area, places(samples));
        let ended = iterate(&points, &search, near.transform, &fine, progress)?;
        let iterations = near.iterations + ended.alignment.iterations;
        if !ended.has_converged {
            return Err(AlignmentError::NotConverged {
                iterations,
                change: ended.change,
                wanted: self.relative_change,
            });
        }
        let observations: Vec<Observation> =
            ended.pairs.iter().map(|pair| pair.observation(piece)).collect();
        let uncertainty = RigidUncertainty::new(&observations, ended.alignment.rms);
        Ok(SurfaceAlignment { iterations, uncertainty, ..ended.alignment })
    }
}

/// How the moving surface lies, and what is opposite what.
struct State {
    transform: RigidTransform,
    pairs: Vec<Pair>,
    points: usize,
}

impl State {
    fn new(points: &[Vector], search: &SurfaceSearch, transform: RigidTransform) -> Self {
        State { transform, pairs: pairs_of(points, search, &transform), points: points.len() }
    }

    /// The square of the distance beyond which a pair does not count.
    fn limit(&self) -> f64 {
        let mut squares: Vec<f64> = self.pairs.iter().map(|pair| pair.squared_distance).collect();
        if squares.is_empty() {
            return 0.0;
        }
        let middle = squares.len() / 2;
        LIMIT_BY_MEDIAN * *squares.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    fn counting(&self, limit: f64) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(move |pair| pair.squared_distance <= limit)
    }

    /// The sum of squared distances, each at most the limit; what has no partner is at the limit.
    fn cut_sum(&self, limit: f64) -> f64 {
        let sum: f64 = self.pairs.iter().map(|pair| pair.squared_distance.min(limit)).sum();
        sum + limit * (self.points - self.pairs.len()) as f64
    }

    fn share_far(&self) -> f64 {
        let far = self.pairs.iter().filter(|pair| pair.squared_distance > FAR * FAR).count();
        far as f64 / self.pairs.len().max(1) as f64
    }

    /// How many pairs count, and their mean squared distance.
    fn mean(&self, limit: f64) -> Result<(usize, f64), AlignmentError> {
        let pairs = self.counting(limit).count();
        if pairs < FEWEST_PAIRS {
            return Err(AlignmentError::NoOverlap { pairs, points: self.points });
        }
        let sum: f64 = self.counting(limit).map(|pair| pair.squared_distance).sum();
        Ok((pairs, sum / pairs as f64))
    }

    /// What it is as an alignment, of no known uncertainty, and the pairs that count.
    fn into_alignment(
        self,
        limit: f64,
        iterations: usize,
    ) -> Result<(SurfaceAlignment, Vec<Pair>), AlignmentError> {
        let (pairs, mean) = self.mean(limit)?;
        let (transform, rms, points) = (self.transform, mean.sqrt(), self.points);
        let (share_far, uncertainty) = (self.share_far(), None);
        let alignment =
            SurfaceAlignment { transform, iterations, rms, points, pairs, share_far, uncertainty };
        Ok((alignment, self.counting(limit).copied().collect()))
    }
}

pub(super) fn iterate(
    points: &[Vector],
    search: &SurfaceSearch,
    start: RigidTransform,
    stop: &StopRule,
    progress: &dyn Progress,
) -> Result<IterationState, AlignmentError> {
    let rounding = ROUNDING * (largest(points) + largest(&[start.inverse().apply(&points[0])]));
    let mut state = State::new(points, search, start);
    let mut limit = state.limit();
    let (mut iterations, mut steps, mut damping, mut change) = (0, 0, 0.0, f64::INFINITY);
    let mut still = 0;
    loop {
        let (_, mean) = state.mean(limit)?;
        let is_still = change <= stop.relative_change && damping < 1.0;
        let is_still = is_still || still >= STILL_STEPS;
        let has_converged = is_still || damping > LAST_DAMPING || mean <= rounding * rounding;
        if has_converged || iterations >= stop.max_iterations {
            let (alignment, pairs) = state.into_alignment(limit, iterations)?;
            return Ok(IterationState { alignment, pairs, change, has_converged });
        }
        if progress.is_cancelled() {
            return Err(AlignmentError::Cancelled { iterations });
        }
        iterations += 1;
        let counting: Vec<Pair> = state.counting(limit).copied().collect();
        let transform = state.transform.then(&point_to_plane(&counting, damping));
        let next = State::new(points, search, transform);
        if next.cut_sum(limit) <= state.cut_sum(limit) {
            change = (next.mean(limit)?.1 - mean).abs() / mean;
            still = if change <= stop.relative_change { still + 1 } else { 0 };
            damping = if damping > FIRST_DAMPING { damping * 0.1 } else { 0.0 };
            state = next;
            if steps < SHRINKING_STEPS {
                limit = limit.min(state.limit());
            }
            steps += 1;
        } else {
            damping = (damping * 10.0).max(FIRST_DAMPING);
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
            let query = back.apply(fixed);
            let closest = search.closest(&query);
            if search.is_on_open_border(&closest) {
                return None;
            }
            let between = (query - closest.point).try_normalize(SAME_PLACE);
            let normal = search.pseudo_normal(&closest);
            let direction = match closest.feature {
                Feature::Face => normal,
                _ => between.unwrap_or(normal),
            };
            Some(Pair {
                fixed: *fixed,
                moving: transform.apply(&closest.point),
                direction: transform.rotation * direction,
                normal: transform.rotation * normal,
                squared_distance: closest.distance * closest.distance,
            })
        })
        .collect();
    pairs.into_iter().flatten().collect()
}

/// The small turn and shift that minimise the distances along their directions.
fn point_to_plane(pairs: &[Pair], damping: f64) -> RigidTransform {
    let moving: Vec<Vector> = pairs.iter().map(|pair| pair.moving).collect();
    let (centre, radius) = middle_and_radius(&moving);
    let mut matrix = Matrix6::zeros();
    let mut right = Vector6::zeros();
    for pair in pairs {
        // The turn is measured by the shift it causes at `radius`, so that all unknowns are lengths.
        let turn = ((pair.moving - centre) / radius).cross(&pair.direction);
        let shift = pair.direction;
        let row = Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z);
        matrix += row * row.transpose();
        right += row * shift.dot(&(pair.fixed - pair.moving));
    }
    let modes = matrix.symmetric_eigen();
    let stiffest = modes.eigenvalues.amax();
    let added = damping * modes.eigenvalues.mean();
    let mut solution = Vector6::zeros();
    for (value, mode) in modes.eigenvalues.iter().zip(modes.eigenvectors.column_iter()) {
        if *value > FREE_DIRECTION * stiffest {
            solution += mode * (mode.dot(&right) / (value + added));
        }
    }
    let turn = Vector::new(solution[0], solution[1], solution[2]) / radius;
    let shift = Vector::new(solution[3], solution[4], solution[5]);
    RigidTransform::about(&centre, *Rotation3::new(turn).matrix(), shift)
}

fn largest(points: &[Vector]) -> f64 {
    points.iter().map(Vector::amax).fold(0.0, f64::max)
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
