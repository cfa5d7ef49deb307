//! Multigrid by aggregation for elasticity: a preconditioner whose work does not grow with the mesh.
//!
//! Coarse unknowns are the rigid movements of aggregates of rows. The prolongator is a partition of
//! unity times exact rigid movements, P_iI = w_iI [ I | R(x_i - c_I) ], with scalar weights from one
//! damped Jacobi step on the Laplacian that the traces of the blocks make: rigid modes are reproduced
//! exactly, and stiff bands are respected because the traces carry their stiffness. After Vanek, Mandel,
//! Brezina 1996 (smoothed aggregation), with the smoothing moved from vectors to scalar weights.
//!
//! A cycle is V(1,1): a forward Gauss-Seidel sweep before and a backward one after the coarse
//! correction, which keeps the preconditioner symmetric. Matrices are f32: a preconditioner needs no
//! more digits, and reads half the memory.

mod aggregation;
mod dense;
mod half_matrix;
mod prolongator;
mod rows;

use dense::DenseInverse;
use half_matrix::HalfMatrix;
use prolongator::Prolongator;
use rows::BlockRows;

use super::LinearSystem;

/// Rows of the first aggregates, and of the later ones.
const FIRST_AGGREGATE: usize = 20;
const LATER_AGGREGATE: usize = 10;

/// Coarse rows at which the dense inverse takes over.
const DENSE_ROWS: usize = 40;

/// A hierarchy for one matrix and one set of held unknowns.
pub struct Multigrid {
    finest: HalfMatrix<3>,
    /// From the finest to the first coarse level.
    first: Prolongator<3>,
    levels: Vec<CoarseLevel>,
    coarsest: DenseInverse,
}

/// A coarse level with a still coarser one below it.
struct CoarseLevel {
    matrix: HalfMatrix<6>,
    below: Prolongator<6>,
}

impl Multigrid {
    /// Builds the hierarchy.
    pub fn new(system: &LinearSystem) -> Self {
        let first = Prolongator::finest(system);
        let mut matrix = first.galerkin(system);
        let mut centres = first.centres.clone();
        let mut levels = Vec::new();
        while matrix.rows() > DENSE_ROWS {
            let below = Prolongator::coarse(&matrix, &centres);
            if below.centres.len() >= matrix.rows() {
                break;
            }
            let next = below.galerkin(&matrix);
            centres.clone_from(&below.centres);
            levels.push(CoarseLevel { matrix: HalfMatrix::of(&matrix), below });
            matrix = next;
        }
        let coarsest = DenseInverse::of(&matrix);
        Multigrid { finest: HalfMatrix::of(system), first, levels, coarsest }
    }

    /// One V cycle from zero: `correction` approximates K^-1 `residual`.
    pub fn apply(&self, residual: &[f64], correction: &mut [f64]) {
        // f32 holds 38 decades; scaling by the largest entry keeps every residual inside them.
        let scale = residual.iter().fold(0.0_f64, |largest, r| largest.max(r.abs()));
        if scale == 0.0 {
            correction.fill(0.0);
            return;
        }
        let scaled: Vec<f32> = residual.iter().map(|r| (r / scale) as f32).collect();
        let result = self.finest.cycle(&scaled, |rest| {
            let below = self.first.restrict(rest);
            self.first.prolong(&self.descend(0, below))
        });
        for (correction, value) in correction.iter_mut().zip(result) {
            *correction = f64::from(value) * scale;
        }
    }

    fn descend(&self, depth: usize, residual: Vec<f32>) -> Vec<f32> {
        match self.levels.get(depth) {
            None => self.coarsest.apply(&residual),
            Some(level) => level.matrix.cycle(&residual, |rest| {
                let below = level.below.restrict(rest);
                level.below.prolong(&self.descend(depth + 1, below))
            }),
        }
    }
}
