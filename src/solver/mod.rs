//! Symmetric positive definite systems of 3x3 blocks: matrices, residuals, tolerances, and the choice
//! between a factorisation and iterations.

pub mod block_matrix;
pub mod cholesky;
pub mod conjugate_gradient;
pub mod mixed;
pub mod multigrid;
pub mod ordering;
pub mod sparse_rows;
mod vector;

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

pub use block_matrix::{Block, BlockMatrix};
pub use vector::norm;

/// K x = f for the free unknowns. Unknown 3 i + c is component c of row i.
pub struct LinearSystem<'a> {
    pub matrix: &'a BlockMatrix,
    /// True where an unknown is held at zero; such rows of the equations are left out.
    pub held: &'a [bool],
    /// Zero where held.
    pub right_hand_side: &'a [f64],
    /// Where each row stands, in mm: rigid movements of neighbourhoods are what varies slowly.
    pub positions: &'a [Vector3<f64>],
    /// Rows whose unknowns are along axes of their own, one axis a column.
    pub axes: &'a BTreeMap<usize, Matrix3<f64>>,
}

/// What a solution has to meet and what finding it may take.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// |f - K x| / |f| over the free unknowns.
    pub relative_residual: f64,
    pub memory_mb: f64,
}

/// Told each iteration and its relative residual; answers whether to go on.
pub type Watch<'a> = &'a dyn Fn(usize, f64) -> bool;

/// A solution that meets its tolerance, and how it was found.
#[derive(Clone, Debug)]
pub struct Solution {
    pub unknowns: Vec<f64>,
    pub method: &'static str,
    pub preconditioner: &'static str,
    /// Why this method was chosen, with the numbers.
    pub why: String,
    pub iterations: usize,
    /// Recomputed from the solution at the end.
    pub relative_residual: f64,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    #[error("stopped on request")]
    Stopped,
    #[error("residual {residual:.2e} after {iterations} iterations, wanted {wanted:.2e}")]
    NotConverged { iterations: usize, residual: f64, wanted: f64, history: Vec<f64> },
    #[error("the matrix is not positive definite at row {row}")]
    NotPositiveDefinite { row: usize },
    #[error("the matrix or the right-hand side has values that are not finite")]
    NotFinite,
    #[error("the solver needs about {needed_mb:.0} MB and may take {allowed_mb:.0} MB")]
    OverBudget { needed_mb: f64, allowed_mb: f64 },
}

/// Up to this many multiplications a factorisation takes about as long as iterations do, or less.
/// Measured on face-like shells and the hexahedral face (docs/performance.md).
const CHOLESKY_WORK: f64 = 6e9;

/// Above this many rows even the ordering of a factorisation costs more than it can save.
const ORDERING_ROWS: usize = 150_000;

/// Solves by Cholesky where its predicted work and memory are small, by conjugate gradients otherwise,
/// and by Cholesky once more where conjugate gradients stall and the factor fits into memory.
pub fn solve(
    system: &LinearSystem,
    tolerance: &Tolerance,
    watch: Watch,
) -> Result<Solution, SolverError> {
    if system.right_hand_side.iter().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    if norm(system.right_hand_side) == 0.0 {
        return Ok(nothing_to_solve(system.right_hand_side.len()));
    }
    let iterations_mb = system.matrix.megabytes();
    if iterations_mb > tolerance.memory_mb {
        let (needed_mb, allowed_mb) = (iterations_mb, tolerance.memory_mb);
        return Err(SolverError::OverBudget { needed_mb, allowed_mb });
    }
    if system.matrix.rows() > ORDERING_ROWS {
        let why = format!("{} rows are too many to factorise", system.matrix.rows());
        return conjugate_gradient::solve(system, tolerance, watch, why);
    }
    let ordering = ordering::minimum_degree(system.matrix);
    let fits = ordering.factor_mb + iterations_mb <= tolerance.memory_mb;
    let cost = format!(
        "a factor would take {:.1e} multiplications and {:.0} MB",
        ordering.multiplications, ordering.factor_mb
    );
    if fits && ordering.multiplications <= CHOLESKY_WORK {
        return cholesky::solve(system, &ordering, tolerance, watch, cost);
    }
    match conjugate_gradient::solve(system, tolerance, watch, cost) {
        Err(SolverError::NotConverged { iterations, residual, .. }) if fits => {
            let why = format!(
                "conjugate gradients stalled at {residual:.1e} after {iterations} iterations"
            );
            cholesky::solve(system, &ordering, tolerance, watch, why)
        }
        other => other,
    }
}

fn nothing_to_solve(unknowns: usize) -> Solution {
    Solution {
        unknowns: vec![0.0; unknowns],
        method: "none",
        preconditioner: "none",
        why: "nothing moves and nothing acts".to_owned(),
        iterations: 0,
        relative_residual: 0.0,
    }
}

/// f - K x with zeros where held, into `residual`.
fn residual_of(system: &LinearSystem, unknowns: &[f64], residual: &mut [f64]) {
    system.matrix.multiply(unknowns, residual);
    for (index, value) in residual.iter_mut().enumerate() {
        *value = if system.held[index] { 0.0 } else { system.right_hand_side[index] - *value };
    }
}
