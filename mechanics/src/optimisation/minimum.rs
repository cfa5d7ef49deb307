//! Levenberg and Marquardt's method within bounds.
//!
//! Each step is the best one of the problem linearised here, kept to the bounds, with a damping that
//! is raised where the linearisation promised too much (Moré, The Levenberg-Marquardt algorithm:
//! implementation and theory, Lecture Notes in Mathematics 630, 1978; ours raises and lowers the
//! damping by factors). It starts without damping: skin is nearly linear in the movements of surgery.

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

/// Goes down from rest, or from where the bounds begin.
pub fn minimise(unknowns: &Unknowns, reduction: &Reduction) -> Result<Minimum, OptimisationError> {
    let residual_at = |at: &DVector<f64>| reduction.residual(&unknowns.coefficients(at));
    let mut at = unknowns.feasible_rest();
    let mut residual = residual_at(&at);
    let mut damping = 0.0;
    let mut step = DVector::zeros(at.len());
    for iterations in 0..MOST_ITERATIONS {
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
    let (iterations, step, wanted) = (MOST_ITERATIONS, step.amax(), SMALL_STEP);
    Err(OptimisationError::NotConverged { iterations, step, wanted })
}
