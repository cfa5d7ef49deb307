//! Symmetric positive definite systems of 3x3 blocks: matrices, residuals, tolerances, and the choice
//! between a factorisation and iterations.

pub mod cholesky;
pub mod cliques;
pub mod conjugate_gradient;
pub mod half_matrix;
pub mod lanes;
pub mod layout;
pub mod mixed;
pub mod mixed_system;
pub mod multigrid;
pub mod ordering;
mod report;
mod scaling;
pub mod sparse_rows;
pub mod stationary;
mod system;
mod vector;
mod vectorised;
pub use half_matrix::HalfMatrix;
pub use report::SolveReport;
pub use vectorised::vectorised;
pub use system::{Block, PartlyHeld, Solution, SolverError, System, Tolerance, Unknowns, tell};

use crate::progress::Progress;

/// Up to this many rows a factorisation takes about as long as iterations do, or less.
const CHOLESKY_ROWS: usize = 2_500;

/// Up to this many multiplications, about half a second, a factorisation may stand in for iterations
/// that stall. It cannot be interrupted.
const CHOLESKY_WORK: f64 = 6e9;

/// Above this many rows even the ordering of a factorisation costs more than it can save.
const ORDERING_ROWS: usize = 150_000;

/// Solves for each right-hand side: by Cholesky where the system is small, by conjugate gradients
/// otherwise, and by Cholesky once more where those stall and the factor is affordable.
pub fn solve(
    system: &System,
    right_hand_sides: &[Unknowns],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    if right_hand_sides.iter().flatten().flatten().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    if right_hand_sides.iter().flatten().flatten().all(|value| *value == 0.0) {
        let at_rest = SolveReport::at_rest(system.free_unknowns(), tolerance.relative_residual);
        return Ok(right_hand_sides.iter().map(|f| nothing_to_solve(f, &at_rest)).collect());
    }
    let iterations_mb = system.megabytes();
    if iterations_mb > tolerance.memory_mb {
        let (needed_mb, allowed_mb) = (iterations_mb, tolerance.memory_mb);
        return Err(SolverError::OverBudget { needed_mb, allowed_mb });
    }
    let rows = system.layout.free;
    if rows <= CHOLESKY_ROWS {
        let ordering = ordering::minimum_degree(system);
        if ordering.factor_mb + iterations_mb <= tolerance.memory_mb {
            let why = format!("{rows} rows are few enough to factorise");
            let solved = cholesky::solve(system, &ordering, right_hand_sides, tolerance, progress);
            return solved.map(|solutions| because(solutions, &why));
        }
    }
    let why = format!("{rows} rows are cheaper to iterate than to factorise");
    match conjugate_gradient::solve(system, right_hand_sides, tolerance, progress) {
        Err(stalled @ SolverError::NotConverged { .. }) if rows <= ORDERING_ROWS => {
            let ordering = ordering::minimum_degree(system);
            let fits = ordering.factor_mb + iterations_mb <= tolerance.memory_mb;
            if !fits || ordering.multiplications > CHOLESKY_WORK {
                return Err(stalled);
            }
            let why = format!("conjugate gradients stalled: {stalled}");
            cholesky::solve(system, &ordering, right_hand_sides, tolerance, progress)
                .map(|solutions| because(solutions, &why))
        }
        other => other.map(|solutions| because(solutions, &why)),
    }
}

fn because(mut solutions: Vec<Solution>, why: &str) -> Vec<Solution> {
    solutions.iter_mut().for_each(|solution| why.clone_into(&mut solution.report.why));
    solutions
}

fn nothing_to_solve(right_hand_side: &Unknowns, at_rest: &SolveReport) -> Solution {
    Solution { unknowns: vec![[0.0; 3]; right_hand_side.len()], report: at_rest.clone() }
}
