//! Right-hand sides of forces and volumes of a size whose squares neither vanish nor overflow.

use super::mixed_system::{MixedRightHandSide, MixedSolution, MixedSystem};
use super::report::SolveReport;
use super::scaling::{factor, times};
use super::system::{Solution, SolverError};

/// Solves for right-hand sides of usual size, and takes the solutions back to the size of those given.
pub(super) fn scaled(
    system: &MixedSystem,
    right_hand_sides: &[MixedRightHandSide],
    wanted: f64,
    solve: impl FnOnce(&[MixedRightHandSide]) -> Result<Vec<MixedSolution>, SolverError>,
) -> Result<Vec<MixedSolution>, SolverError> {
    let is_zero = |right: &MixedRightHandSide| {
        let mut values = right.forces.as_flattened().iter().chain(right.volumes.as_flattened());
        values.all(|value| *value == 0.0)
    };
    if right_hand_sides.iter().all(is_zero) {
        let pressures = vec![[0.0]; system.coupling.mass.len()];
        let at_rest = SolveReport::at_rest(system.free_unknowns(), wanted);
        let rest = |right: &MixedRightHandSide| MixedSolution {
            solution: Solution::at_rest(right.forces.len(), &at_rest),
            pressures: pressures.clone(),
        };
        return Ok(right_hand_sides.iter().map(rest).collect());
    }
    let factors: Vec<f64> = right_hand_sides.iter().map(factor_of).collect();
    if factors.iter().all(|factor| *factor == 1.0) {
        return solve(right_hand_sides);
    }
    let sides = right_hand_sides.iter().zip(&factors);
    let of_usual_size: Vec<MixedRightHandSide> = sides
        .map(|(right, &factor)| MixedRightHandSide {
            forces: times(&right.forces, factor),
            volumes: times(&right.volumes, factor),
        })
        .collect();
    let mut solutions = solve(&of_usual_size)?;
    for (mixed, factor) in solutions.iter_mut().zip(factors) {
        mixed.solution.unknowns = times(&mixed.solution.unknowns, factor.recip());
        mixed.pressures = times(&mixed.pressures, factor.recip());
    }
    Ok(solutions)
}

/// The power of two that brings forces and volumes to a size whose squares neither vanish nor overflow.
fn factor_of(right: &MixedRightHandSide) -> f64 {
    factor(right.forces.as_flattened().iter().chain(right.volumes.as_flattened()))
}
