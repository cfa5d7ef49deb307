//! Levenberg and Marquardt's method within bounds.
//!
//! Each step is the best one of the problem linearised here, kept to the bounds, with a damping that
//! is raised where the linearisation promised too much (Moré, The Levenberg-Marquardt algorithm:
//! implementation and theory, Lecture Notes in Mathematics 630, 1978; ours raises and lowers the
//! damping by factors). It starts without damping: skin is nearly linear in the movements of surgery.
//!
//! Turned far it is not, and the way down from rest may end in a minimum that is not the least. Where angles may be large it is gone
//! down from other starts too (`starts`), and the lowest end is kept.

use nalgebra::DVector;

use super::OptimisationError;
use super::bounded_step::{Linearised, StepBounds};
use super::reduction::Reduction;
use super::unknowns::Unknowns;

/// The undamped step in mm, or degrees, at which the minimum is found.
const SMALL_STEP: f64 = 1e-8;
/// It is found as well where no step promises to lower the sum by more than this share, a hundred
/// thousandth of a standard error in the movement, or by more than rounding.
const SMALL_PROMISE: f64 = 1e-10;
const ROUNDING: f64 = 1e-13;
/// Surgery takes ten; targets tens of mm away from any skin have been seen to take 150.
const MOST_ITERATIONS: usize = 1000;
/// From starts other than the first: where they take more, another one is as good.
const MOST_FROM_ELSEWHERE: usize = 200;

/// A sum that is lower by less than this share, which is more than the ends of two ways into one minimum differ by, is as low.
const AS_LOW: f64 = 1e-6;

/// Minima whose movements differ by less, in mm and in entries of a rotation, are one.
const SAME_MOVEMENT: f64 = 0.01;

/// Dampings as shares of the largest eigenvalue of JᵀJ: the first one, and the one below which there is none.
const FIRST_DAMPING: f64 = 1e-4;
const LEAST_DAMPING: f64 = 1e-8;

/// Where the sum of squares is least.
pub struct Minimum {
    pub unknowns: DVector<f64>,
    pub linearised: Linearised,
    pub residual: DVector<f64>,
    pub iterations: usize,
}

/// The lowest of the minima that ways from several starts end in.
pub struct LowestMinimum {
    pub minimum: Minimum,
    /// The other ends that are minima of their own: higher, or of other movements.
    pub others: Vec<OtherMinimum>,
}

/// A minimum beside the lowest one.
pub struct OtherMinimum {
    pub square_sum: f64,
    pub is_higher: bool,
}

/// Goes down from each start. A later one counts where it ends lower than those before it.
pub fn lowest(
    unknowns: &Unknowns,
    reduction: &Reduction,
    starts: &[DVector<f64>],
) -> Result<LowestMinimum, OptimisationError> {
    let sum = |own: &Minimum| own.residual.norm_squared() + reduction.unreachable;
    let as_low = |own: &Minimum| AS_LOW * sum(own) + ROUNDING * reduction.size().powi(2);
    let (mut ends, mut failure) = (Vec::with_capacity(starts.len()), None);
    for (number, start) in starts.iter().enumerate() {
        let most = if number == 0 { MOST_ITERATIONS } else { MOST_FROM_ELSEWHERE };
        match minimise(unknowns, reduction, start.clone(), most) {
            Ok(end) => ends.push(end),
            Err(error) => failure = failure.or(Some(error)),
        }
    }
    let mut best = 0;
    for place in 1..ends.len() {
        if sum(&ends[place]) + as_low(&ends[best]) < sum(&ends[best]) {
            best = place;
        }
    }
    if ends.is_empty() {
        let none = OptimisationError::NotConverged { iterations: 0, step: 0.0, wanted: SMALL_STEP };
        return Err(failure.unwrap_or(none));
    }
    let minimum = ends.swap_remove(best);
    let numbers = unknowns.movement_numbers(&minimum.unknowns);
    let other = |end: &Minimum| {
        let is_higher = sum(end) > sum(&minimum) + as_low(&minimum);
        let apart = (unknowns.movement_numbers(&end.unknowns) - &numbers).amax();
        let own = OtherMinimum { square_sum: sum(end), is_higher };
        (is_higher || apart > SAME_MOVEMENT).then_some(own)
    };
    let others = ends.iter().filter_map(other).collect();
    Ok(LowestMinimum { minimum, others })
}

/// Goes down from a point within the bounds.
fn minimise(
    unknowns: &Unknowns,
    reduction: &Reduction,
    start: DVector<f64>,
    most_iterations: usize,
) -> Result<Minimum, OptimisationError> {
    let residual_at = |at: &DVector<f64>| reduction.residual(&unknowns.coefficients(at));
    let mut at = start;
    let mut residual = residual_at(&at);
    let mut damping = 0.0;
    let mut step = DVector::zeros(at.len());
    for iterations in 0..most_iterations {
        let jacobian = reduction.jacobian(&unknowns.derivatives(&at));
        let linearised = Linearised::new(jacobian, residual.clone());
        let room = StepBounds { lower: &unknowns.lower - &at, upper: &unknowns.upper - &at };
        step = linearised.step(0.0, &room);
        let size = residual.norm();
        let small = SMALL_PROMISE * size * size + ROUNDING * size * reduction.size();
        let mut is_found = step.amax() <= SMALL_STEP;
        // A damping left over from before says nothing about what larger steps could do.
        let mut is_long = damping == 0.0;
        while !is_found {
            let damped = linearised.step(damping * linearised.largest, &room);
            let promised = linearised.promise(&damped);
            let next = unknowns.within(&at + &damped);
            let next_residual = residual_at(&next);
            let kept = (residual.norm_squared() - next_residual.norm_squared()) / promised;
            is_found = is_long && promised <= small;
            if kept.is_nan() || kept < 0.25 {
                damping = (4.0 * damping).max(FIRST_DAMPING);
                is_long = true;
            }
            if kept > 1e-4 && !is_found {
                (at, residual) = (next, next_residual);
                if kept > 0.75 {
                    damping = if damping > LEAST_DAMPING { damping / 10.0 } else { 0.0 };
                }
                break;
            }
        }
        if is_found {
            return Ok(Minimum { unknowns: at, linearised, residual, iterations });
        }
    }
    let (iterations, step, wanted) = (most_iterations, step.amax(), SMALL_STEP);
    Err(OptimisationError::NotConverged { iterations, step, wanted })
}
