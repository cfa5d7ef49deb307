//! A linear system with free, held and partly held rows, what its solution has to meet, and how solving it fails.

use super::half_matrix::HalfMatrix;
use super::lanes::{Lanes, Real};
use super::report::SolveReport;
use super::row_ordering::RowOrdering;
use crate::progress::Progress;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A 3x3 block, row-major.
pub type Block = [[f64; 3]; 3];

/// One value for each component of each row.
pub type Unknowns = Vec<[f64; 3]>;

/// K x = f for the free unknowns. Rows are numbered by place.
pub struct System {
    pub ordering: Arc<RowOrdering>,
    /// All rows, held ones last.
    pub matrix: HalfMatrix<f64, 3>,
    /// Free rows that are not free in all three unknowns, or have axes of their own.
    pub partly_constrained: Vec<PartlyHeld>,
    /// Where each row stands, in mm: rigid movements of neighbourhoods are what varies slowly.
    pub positions: Vec<Vector3<f64>>,
}

/// A row with unknowns along its own axes.
#[derive(Clone, Debug, PartialEq)]
pub struct PartlyHeld {
    pub row: usize,
    /// True where an unknown is held at zero; such equations are left out.
    pub held: [bool; 3],
    /// One axis a column.
    pub axes: Matrix3<f64>,
}

/// Tolerance and limits of a solution.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// |f - K x| / |f| over the free unknowns.
    pub relative_residual: f64,
    pub memory_mb: f64,
}

/// A solution that meets its tolerance, and how it was found.
#[derive(Clone, Debug)]
pub struct Solution {
    /// For each free row.
    pub unknowns: Unknowns,
    pub report: SolveReport,
}

impl Solution {
    /// That of so many rows on which nothing acts.
    pub(super) fn at_rest(rows: usize, report: &SolveReport) -> Self {
        Solution { unknowns: vec![[0.0; 3]; rows], report: report.clone() }
    }
}

/// Why there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    #[error("stopped on request")]
    Stopped,
    #[error("residual {residual:.2e} after {iterations} iterations, wanted {wanted:.2e}")]
    NotConverged { iterations: usize, residual: f64, wanted: f64, history: Vec<f64> },
    #[error(
        "diverged: the residual grew {growth:.3} times an iteration, to {residual:.1e} after {iterations}"
    )]
    Diverged { iterations: usize, growth: f64, residual: f64, history: Vec<f64> },
    /// The place of a node in the system, until `Constrained::in_nodes` of the model gives its number.
    #[error("the matrix is singular at node {node}")]
    Singular { node: usize },
    #[error("the solution has values that are not finite")]
    NotFinite,
    #[error("the problem needs about {needed_mb:.0} MB and may take {allowed_mb:.0} MB")]
    OverBudget { needed_mb: f64, allowed_mb: f64 },
}

impl SolverError {
    /// The stable word of the error catalogue.
    pub fn code(&self) -> &'static str {
        match self {
            SolverError::Stopped => "cancelled",
            SolverError::NotConverged { .. }
            | SolverError::Diverged { .. }
            | SolverError::NotFinite => "solver-diverged",
            SolverError::Singular { .. } => "matrix-singular",
            SolverError::OverBudget { .. } => "budget-exceeded",
        }
    }
}

/// Tells an iteration with its relative residual and the one asked for, and whether to go on.
pub fn tell(
    progress: &dyn Progress,
    iteration: usize,
    relative_residual: f64,
    wanted: f64,
) -> Result<(), SolverError> {
    progress.iteration(iteration, relative_residual, wanted);
    match progress.is_cancelled() {
        true => Err(SolverError::Stopped),
        false => Ok(()),
    }
}

impl System {
    /// Displacements by row of unknowns of which three belong to each free row; zero where held.
    pub fn by_row(&self, unknowns: &[[f64; 1]]) -> Vec<Lanes<f64, 3, 1>> {
        let (displacements, _) = unknowns.split_at(3 * self.ordering.free);
        let mut by_row = vec![[[0.0]; 3]; self.matrix.rows()];
        by_row.iter_mut().zip(displacements.as_chunks::<3>().0).for_each(|(own, u)| *own = *u);
        by_row
    }

    /// Memory of the matrix, of a multigrid hierarchy for it and of the vectors of the iterations, in MB.
    pub fn megabytes(&self) -> f64 {
        // The hierarchy has half of the bytes of the finest level and some 40 % of that for coarser ones.
        let hierarchy = 0.7 * self.matrix.megabytes();
        let vectors = self.ordering.free as f64 * (4.0 * 24.0 + 3.0 * 12.0 + 64.0) / 1e6;
        self.matrix.megabytes() + hierarchy + vectors
    }

    /// The number of unknowns that are not held.
    pub fn free_unknowns(&self) -> usize {
        let held =
            self.partly_constrained.iter().flat_map(|row| row.held).filter(|held| *held).count();
        3 * self.ordering.free - held
    }

    /// K x over the free unknowns; zero where held.
    pub fn multiply<const N: usize>(
        &self,
        x: &[Lanes<f64, 3, N>],
        product: &mut [Lanes<f64, 3, N>],
    ) {
        self.matrix.multiply(&self.ordering, x, product);
        self.zero_constrained(product);
    }

    /// Zeros where held.
    pub(super) fn zero_constrained<const N: usize>(&self, values: &mut [Lanes<f64, 3, N>]) {
        self.partly_constrained
            .iter()
            .for_each(|partly| partly.zero_constrained(&mut values[partly.row]));
    }

    /// f - K x, zero where held, into `residual`.
    pub(super) fn residual<const N: usize>(
        &self,
        right_hand_side: &[Lanes<f64, 3, N>],
        x: &[Lanes<f64, 3, N>],
        residual: &mut [Lanes<f64, 3, N>],
    ) {
        self.multiply(x, residual);
        for (value, right) in residual.iter_mut().zip(right_hand_side) {
            for c in 0..3 {
                for n in 0..N {
                    value[c][n] = right[c][n] - value[c][n];
                }
            }
        }
    }
}

impl PartlyHeld {
    pub(super) fn zero_constrained<T: Real, const N: usize>(&self, values: &mut Lanes<T, 3, N>) {
        for (value, _) in values.iter_mut().zip(self.held).filter(|(_, held)| *held) {
            *value = [T::default(); N];
        }
    }

    /// From the row's own axes to those of the coordinates.
    pub(super) fn to_coordinates<const N: usize>(&self, values: &mut Lanes<f32, 3, N>) {
        let own = *values;
        for (i, value) in values.iter_mut().enumerate() {
            for n in 0..N {
                value[n] = (0..3).map(|k| self.axes[(i, k)] as f32 * own[k][n]).sum();
            }
        }
    }

    /// Back to the row's own axes, with zeros where held.
    pub(super) fn to_own_axes<const N: usize>(&self, values: &mut Lanes<f32, 3, N>) {
        let coordinates = *values;
        for (i, value) in values.iter_mut().enumerate() {
            for n in 0..N {
                value[n] = (0..3).map(|k| self.axes[(k, i)] as f32 * coordinates[k][n]).sum();
            }
        }
        self.zero_constrained(values);
    }
}
