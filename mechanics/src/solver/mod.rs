//! Symmetric positive definite systems of 3x3 blocks: matrices, residuals, tolerances, and the choice
//! between a factorisation and iterations.

pub mod cholesky;
pub mod cliques;
pub mod conjugate_gradient;
pub mod half_matrix;
pub mod lanes;
pub mod layout;
pub mod mixed;
pub mod multigrid;
pub mod ordering;
pub mod sparse_rows;
pub mod stationary;
mod vector;
mod vectorised;

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

pub use half_matrix::HalfMatrix;
use lanes::{Lanes, Real};
use layout::Layout;

/// A 3x3 block, row-major.
pub type Block = [[f64; 3]; 3];

/// One value for each component of each row.
pub type Unknowns = Vec<[f64; 3]>;

/// K x = f for the free unknowns. Rows are numbered by place.
pub struct System {
    pub layout: Arc<Layout>,
    /// All rows, held ones last.
    pub matrix: HalfMatrix<f64, 3>,
    /// Free rows that are not free in all three unknowns, or have axes of their own.
    pub partly_held: Vec<PartlyHeld>,
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
    /// For each free row.
    pub unknowns: Unknowns,
    pub method: &'static str,
    pub preconditioner: &'static str,
    /// Why this method was chosen, with the numbers; empty where nothing chose.
    pub why: String,
    pub iterations: usize,
    /// Recomputed from the solution at the end.
    pub relative_residual: f64,
    /// The relative residual after each iteration, where iterations were asked for and not chosen.
    pub history: Vec<f64>,
}

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
    #[error("the matrix is not positive definite at row {row}")]
    NotPositiveDefinite { row: usize },
    #[error("the matrix or the right-hand side has values that are not finite")]
    NotFinite,
    #[error("the solver needs about {needed_mb:.0} MB and may take {allowed_mb:.0} MB")]
    OverBudget { needed_mb: f64, allowed_mb: f64 },
}

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
    watch: Watch,
) -> Result<Vec<Solution>, SolverError> {
    if right_hand_sides.iter().flatten().flatten().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    if right_hand_sides.iter().flatten().flatten().all(|value| *value == 0.0) {
        return Ok(right_hand_sides.iter().map(|f| nothing_to_solve(f.len())).collect());
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
            let solved = cholesky::solve(system, &ordering, right_hand_sides, tolerance, watch);
            return solved.map(|solutions| because(solutions, &why));
        }
    }
    let why = format!("{rows} rows are cheaper to iterate than to factorise");
    match conjugate_gradient::solve(system, right_hand_sides, tolerance, watch) {
        Err(stalled @ SolverError::NotConverged { .. }) if rows <= ORDERING_ROWS => {
            let ordering = ordering::minimum_degree(system);
            let fits = ordering.factor_mb + iterations_mb <= tolerance.memory_mb;
            if !fits || ordering.multiplications > CHOLESKY_WORK {
                return Err(stalled);
            }
            let why = format!("conjugate gradients stalled: {stalled}");
            cholesky::solve(system, &ordering, right_hand_sides, tolerance, watch)
                .map(|solutions| because(solutions, &why))
        }
        other => other.map(|solutions| because(solutions, &why)),
    }
}

fn because(mut solutions: Vec<Solution>, why: &str) -> Vec<Solution> {
    solutions.iter_mut().for_each(|solution| why.clone_into(&mut solution.why));
    solutions
}

fn nothing_to_solve(rows: usize) -> Solution {
    Solution {
        unknowns: vec![[0.0; 3]; rows],
        method: "none",
        preconditioner: "none",
        why: "nothing moves and nothing acts".to_owned(),
        iterations: 0,
        relative_residual: 0.0,
        history: Vec::new(),
    }
}

impl System {
    /// Memory of the matrix, of a multigrid hierarchy for it and of the vectors of the iterations, in MB.
    pub fn megabytes(&self) -> f64 {
        // The hierarchy has half of the bytes of the finest level and some 40 % of that for coarser ones.
        let hierarchy = 0.7 * self.matrix.megabytes();
        let vectors = self.layout.free as f64 * (4.0 * 24.0 + 3.0 * 12.0 + 64.0) / 1e6;
        self.matrix.megabytes() + hierarchy + vectors
    }

    /// K x over the free unknowns; zero where held.
    pub fn multiply<const N: usize>(
        &self,
        x: &[Lanes<f64, 3, N>],
        product: &mut [Lanes<f64, 3, N>],
    ) {
        self.matrix.multiply(&self.layout, x, product);
        self.clear_held(product);
    }

    /// Zeros where held.
    fn clear_held<const N: usize>(&self, values: &mut [Lanes<f64, 3, N>]) {
        self.partly_held.iter().for_each(|partly| partly.clear_held(&mut values[partly.row]));
    }

    /// f - K x, zero where held, into `residual`.
    fn residual<const N: usize>(
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
    fn clear_held<T: Real, const N: usize>(&self, values: &mut Lanes<T, 3, N>) {
        for (value, _) in values.iter_mut().zip(self.held).filter(|(_, held)| *held) {
            *value = [T::default(); N];
        }
    }

    /// From the row's own axes to those of the coordinates.
    fn to_coordinates<const N: usize>(&self, values: &mut Lanes<f32, 3, N>) {
        let own = *values;
        for (i, value) in values.iter_mut().enumerate() {
            for n in 0..N {
                value[n] = (0..3).map(|k| self.axes[(i, k)] as f32 * own[k][n]).sum();
            }
        }
    }

    /// Back to the row's own axes, with zeros where held.
    fn to_own_axes<const N: usize>(&self, values: &mut Lanes<f32, 3, N>) {
        let coordinates = *values;
        for (i, value) in values.iter_mut().enumerate() {
            for n in 0..N {
                value[n] = (0..3).map(|k| self.axes[(k, i)] as f32 * coordinates[k][n]).sum();
            }
        }
        self.clear_held(values);
    }
}
