//! Displacement and pressure together, by conjugate residuals under a block triangular preconditioner.
//!
//!   K u + B^T p = f,  B u - C p = h        A = [[K, B^T], [B, -C]]
//!   preconditioner: u = V r_u, p = S^-1 (B u - r_p), with V one multigrid cycle of K and S = D / 3
//!
//! D is the lumped pressure mass (1/mu + 1/lambda) M. A block triangular preconditioner halves the
//! iterations of a block diagonal one (Murphy, Golub, Wathen 2000), and B u is shared with the product.
//! D / 3 stands for B K^-1 B^T + C: the part B K^-1 B^T is at most 3/(2 mu) M, and of the multiples tried on
//! shells it takes the fewest iterations, about the same for all nu.
//! The iteration is the generalised conjugate residual method of Eisenstat, Elman, Schultz 1983, truncated
//! to the last few directions (ORTHOMIN): every step minimises the residual that is reported.
//!
//! Residual: |(r_u, W r_p)| / |(f, W h)| over free unknowns, with r_u = f - K u - B^T p, r_p = h - B u + C p
//! and W_i = |B_i| / D_i, which turns a volume that is left over into the forces that its pressure would
//! put on the nodes around it. It does not lose its meaning as nu goes to 1/2.

use super::conjugate_gradient::StoppingCriterion;
use super::lanes::MOST_LANES;
pub use super::mixed_iteration::MOST_DIRECTIONS;
use super::mixed_iteration::Run;
use super::mixed_scaling::scaled;
use super::mixed_system::{MixedRightHandSide, MixedSolution, MixedSystem};
use super::vector::column;
use super::{SolverError, Tolerance, Unknowns};
use crate::progress::Progress;

/// Solves for each right-hand side until its true residual is met, or says where it stalled.
pub fn solve(
    system: &MixedSystem,
    right_hand_sides: &[MixedRightHandSide],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<MixedSolution>, SolverError> {
    let wanted = tolerance.relative_residual;
    scaled(system, right_hand_sides, wanted, |right_hand_sides| {
        solve_scaled(system, right_hand_sides, wanted, progress)
    })
}

/// Solves until every relative residual is met or nothing more is gained, and keeps what was found until then.
pub fn solve_best_effort(
    system: &MixedSystem,
    right_hand_sides: &[MixedRightHandSide],
    wanted: f64,
    progress: &dyn Progress,
) -> Result<Vec<MixedSolution>, SolverError> {
    scaled(system, right_hand_sides, wanted, |right_hand_sides| {
        let multigrid = system.solver.hierarchy(system.stiffness, progress)?;
        let mut solutions = Vec::with_capacity(right_hand_sides.len());
        for chunk in right_hand_sides.chunks(MOST_LANES) {
            solutions.extend(match chunk.len() {
                1 => Run::<1>::new(system, multigrid, chunk).solve_best_effort(wanted, progress),
                2..=4 => {
                    Run::<4>::new(system, multigrid, chunk).solve_best_effort(wanted, progress)
                }
                _ => Run::<MOST_LANES>::new(system, multigrid, chunk)
                    .solve_best_effort(wanted, progress),
            }?);
        }
        Ok(solutions)
    })
}

fn solve_scaled(
    system: &MixedSystem,
    right_hand_sides: &[MixedRightHandSide],
    wanted: f64,
    progress: &dyn Progress,
) -> Result<Vec<MixedSolution>, SolverError> {
    let multigrid = system.solver.hierarchy(system.stiffness, progress)?;
    let alone = |right: &MixedRightHandSide| {
        Run::<1>::new(system, multigrid, std::slice::from_ref(right)).solve(wanted, progress)
    };
    let mut solutions = Vec::with_capacity(right_hand_sides.len());
    for chunk in right_hand_sides.chunks(MOST_LANES) {
        let together = match chunk.len() {
            1 => alone(&chunk[0]),
            2..=4 => Run::<4>::new(system, multigrid, chunk).solve(wanted, progress),
            _ => Run::<MOST_LANES>::new(system, multigrid, chunk).solve(wanted, progress),
        };
        match together {
            // Alone each may keep more directions.
            Err(SolverError::NotConverged { .. }) if chunk.len() > 1 => {
                for right in chunk {
                    solutions.extend(alone(right)?);
                }
            }
            other => solutions.extend(other?),
        }
    }
    Ok(solutions)
}

/// A direction towards the solution of a system near to that of the hierarchy.
pub struct MixedDirection {
    /// For each free row.
    pub unknowns: Unknowns,
    pub pressures: Vec<[f64; 1]>,
    pub iterations: usize,
    /// Whether the relative residual was met within the iterations.
    pub is_met: bool,
}

/// Iterates until the relative residual or the bound of iterations is met, and keeps what was found until then.
pub fn direction(
    system: &MixedSystem,
    right_hand_side: &MixedRightHandSide,
    criterion: StoppingCriterion,
    progress: &dyn Progress,
) -> Result<MixedDirection, SolverError> {
    let multigrid = system.solver.hierarchy(system.stiffness, progress)?;
    let mut run = Run::<1>::new(system, multigrid, std::slice::from_ref(right_hand_side));
    run.most_iterations = criterion.most_iterations;
    run.keep = MOST_DIRECTIONS;
    let is_met = match run.iterate(criterion.relative_residual, progress) {
        Ok(()) => true,
        Err(SolverError::NotConverged { .. }) => false,
        Err(other) => return Err(other),
    };
    let (u, p) = run.x.split_at(run.displacements());
    let (unknowns, pressures) = (column(u.as_chunks().0, 0), p.to_vec());
    if run.x.as_flattened().iter().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    Ok(MixedDirection { unknowns, pressures, iterations: run.iterations, is_met })
}
