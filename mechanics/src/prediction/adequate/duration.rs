//! Expected time of the costlier models, as multiples of that of the linear solution with its estimates.
//!
//! Newton's method takes a step for as much of the way as the most pressed cell bears, so that its steps are as many as the linear
//! answer turns that cell inside out: on 289 523 stabilised tetrahedra of a CT 11 and 13 for a smallest det F of -2 in the linear
//! answer, 17 for -3.7, 36 for -8.5, 57 for -10 (docs/finite-strain.md#measured). A step assembles the tangent anew, every second one a
//! hierarchy, and iterates with pressures: a third of a linear answer.

use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::finite_strain::MOST_STEPS;
use crate::model::fem::strain::determinants;

/// The second order.
pub const SECOND_ORDER_TAKES: f64 = 0.7;

/// A step of Newton's method.
const STEP_TAKES: f64 = 0.4;

/// Steps where no cell is turned inside out, and more for each unit of det F below zero.
const STEPS: f64 = 8.0;
const STEPS_TURNED: f64 = 5.0;

/// All rounds in which pressure follows its faces, as multiples of the first.
pub(super) const ROUNDS_TAKE: f64 = 2.5;

/// Newton's method at least and at most, before anything is solved.
pub const NEWTON_MAY_TAKE: [f64; 2] = [STEP_TAKES * STEPS, STEP_TAKES * MOST_STEPS as f64];

/// Newton's method, by the smallest det F of the linear answer.
pub(super) fn newton_relative_time(least_det_f: f64) -> f64 {
    let steps = STEPS + STEPS_TURNED * (-least_det_f).max(0.0);
    STEP_TAKES * steps.min(MOST_STEPS as f64)
}

/// Det F of the cell that a displacement presses most, or turns inside out.
pub(super) fn least_det_f(mesh: &VolumeMesh, displacement: &[Vector]) -> f64 {
    determinants(mesh, displacement).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newton_is_expected_to_take_the_steps_that_it_took_and_at_most_twice_as_many() {
        for (least_det_f, took) in
            [(-2.0, 11.0), (-2.14, 13.0), (-3.65, 17.0), (-8.54, 36.0), (-10.0, 57.0)]
        {
            let steps = newton_relative_time(least_det_f) / STEP_TAKES;
            assert!(took <= steps && steps <= 2.0 * took, "{least_det_f}: {steps}, took {took}");
        }
        assert_eq!(newton_relative_time(-1e6), NEWTON_MAY_TAKE[1]);
        assert_eq!(newton_relative_time(0.5), NEWTON_MAY_TAKE[0]);
    }
}
