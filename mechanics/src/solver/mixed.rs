//! Displacement and pressure together, by conjugate residuals under a block triangular preconditioner.
//!
//!   K u + B^T p = f,  B u - C p = h        A = [[K, B^T], [B, -C]]
//!   preconditioner: u = V r_u, p = S^-1 (B u - r_p), with V one multigrid cycle of K and S = D / 3; where that
//!   stalls V = K^-1 by a factor
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
use super::inverse_stiffness::ReadyInverse;
use super::lanes::MOST_LANES;
use super::mixed_iteration::{MOST_DIRECTIONS, Run};
use super::mixed_scaling::scaled;
use super::mixed_system::{Coupling, MixedRightHandSide, MixedSolution, MixedSystem};
use super::vector::column;
use super::{SolverError, System, Tolerance, Unknowns};
use crate::progress::Progress;

/// Vectors of all unknowns that the iteration keeps at most.
const VECTORS: usize = 2 * MOST_DIRECTIONS + 6;

/// What matrices, hierarchy and vectors take, in MB.
pub fn megabytes(stiffness: &System, coupling: &Coupling) -> f64 {
    let unknowns = 3 * stiffness.ordering.free + coupling.mass.len();
    stiffness.megabytes() + coupling.megabytes() + 8e-6 * (VECTORS * unknowns) as f64
}

/// Solves for each right-hand side until its true residual is met, or says where it stalled.
pub fn solve(
    system: &MixedSystem,
    right_hand_sides: &[MixedRightHandSide],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<MixedSolution>, SolverError> {
    scaled(system, right_hand_sides, tolerance.relative_residual, |right_hand_sides| {
        let mut solutions = Vec::with_capacity(right_hand_sides.len());
        for chunk in right_hand_sides.chunks(MOST_LANES) {
            solutions.extend(solve_chunk(system, chunk, tolerance, progress)?);
        }
        Ok(solutions)
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
        let made = made(system, progress)?;
        let mut solutions = Vec::with_capacity(right_hand_sides.len());
        for chunk in right_hand_sides.chunks(MOST_LANES) {
            solutions.extend(match chunk.len() {
                1 => Run::<1>::new(system, made, chunk).solve_best_effort(wanted, progress),
                2..=4 => Run::<4>::new(system, made, chunk).solve_best_effort(wanted, progress),
                _ => {
                    Run::<MOST_LANES>::new(system, made, chunk).solve_best_effort(wanted, progress)
                }
            }?);
        }
        Ok(solutions)
    })
}

/// The factor of K where one was needed before, its hierarchy otherwise.
fn made<'a>(
    system: &MixedSystem<'a>,
    progress: &dyn Progress,
) -> Result<ReadyInverse<'a>, SolverError> {
    match system.solver.made_factor() {
        Some(factor) => Ok(ReadyInverse::Factor(factor)),
        None => system.solver.hierarchy(system.stiffness, progress).map(ReadyInverse::Cycle),
    }
}

/// Solves for at most eight right-hand sides: together, where that stalls each alone, which may then keep more directions, and
/// where that stalls under multigrid with a factor of K, if it is affordable.
fn solve_chunk(
    system: &MixedSystem,
    chunk: &[MixedRightHandSide],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<MixedSolution>, SolverError> {
    let wanted = tolerance.relative_residual;
    let preconditioner = made(system, progress)?;
    let together = match chunk.len() {
        1 => return solve_alone(system, &chunk[0], tolerance, progress).map(|found| vec![found]),
        2..=4 => Run::<4>::new(system, preconditioner, chunk).solve(wanted, progress),
        _ => Run::<MOST_LANES>::new(system, preconditioner, chunk).solve(wanted, progress),
    };
    match together {
        Err(SolverError::NotConverged { .. }) => {
            chunk.iter().map(|right| solve_alone(system, right, tolerance, progress)).collect()
        }
        other => other,
    }
}

fn solve_alone(
    system: &MixedSystem,
    right: &MixedRightHandSide,
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<MixedSolution, SolverError> {
    let under = |made: ReadyInverse| {
        let run = Run::<1>::new(system, made, std::slice::from_ref(right));
        run.solve(tolerance.relative_residual, progress)
    };
    let made = made(system, progress)?;
    let mut found = match (under(made), made) {
        (Err(stalled @ SolverError::NotConverged { .. }), ReadyInverse::Cycle(_)) => {
            let left_mb = tolerance.memory_mb - megabytes(system.stiffness, system.coupling);
            let factor = system.solver.affordable_factor(system.stiffness, left_mb)?;
            let mut found = under(ReadyInverse::Factor(factor.ok_or(stalled.clone())?))?;
            let why = &mut found[0].solution.report.why;
            *why = format!("{why}; conjugate residuals under multigrid stalled: {stalled}");
            found
        }
        (other, _) => other?,
    };
    Ok(found.remove(0))
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
    let made = ReadyInverse::Cycle(multigrid);
    let mut run = Run::<1>::new(system, made, std::slice::from_ref(right_hand_side));
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
