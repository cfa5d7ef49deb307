//! Multigrid by aggregation for elasticity: a preconditioner whose work does not grow with the mesh.
//!
//! Coarse unknowns are the rigid movements of aggregates of rows. The prolongator is a partition of
//! unity times exact rigid movements, P_iI = w_iI [ I | R(x_i - c_I) ], with scalar weights from one
//! damped Jacobi step on the Laplacian that the traces of the blocks make: rigid modes are reproduced
//! exactly, and stiff bands are respected because the traces carry their stiffness. After Vanek, Mandel,
//! Brezina 1996 (smoothed aggregation), with the smoothing moved from vectors to scalar weights.
//!
//! A cycle is V(1,1): a forward Gauss-Seidel sweep before and a backward one after the coarse
//! correction, which keeps the preconditioner symmetric.

mod aggregation;
mod galerkin;
mod inverse;
mod prolongator;
mod smoother;
mod strength_of_connection;

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use galerkin::{Coarse, Fine, galerkin};
use inverse::{DenseInverse, inverse_block};
use prolongator::{Prolongator, Weights};
use smoother::Smoother;
use strength_of_connection::StrengthOfConnection;

use super::lanes::Lanes;
use super::vector::{norm, ratio};
use super::{PartlyHeld, SolverError, System};
use crate::progress::Progress;

/// Rows of the first aggregates, and of the later ones.
const FIRST_AGGREGATE: usize = 20;
const LATER_AGGREGATE: usize = 10;

/// Rows that one thread scales at a time.
const CHUNK: usize = 4096;

/// Coarse rows at which the dense inverse takes over.
const DENSE_ROWS: usize = 30;

/// Coarse rows up to which the matrix of rows that nothing groups is inverted as a whole: 6 x 500 squared in f64 are
/// 72 MB. More of them are parts that hardly touch each other, and each is inverted alone.
const MOST_DENSE_ROWS: usize = 500;

/// A hierarchy for one matrix and one set of held unknowns.
pub struct Multigrid {
    finest: Smoother<3>,
    partly_constrained: Vec<PartlyHeld>,
    below: CoarseLevels,
}

/// All that lies below the finest level.
struct CoarseLevels {
    /// From the finest to the first coarse level.
    first: Prolongator,
    levels: Vec<CoarseLevel>,
    coarsest: Coarsest,
    coarsest_rows: usize,
}

/// The inverse on the coarsest level.
enum Coarsest {
    Whole(DenseInverse),
    /// Of the block of each row on the diagonal, where there are too many rows for the whole.
    ByRow(Vec<[[f32; 6]; 6]>),
}

impl Coarsest {
    fn apply<const N: usize>(&self, right: &[Lanes<f32, 6, N>], x: &mut [Lanes<f32, 6, N>]) {
        match self {
            Coarsest::Whole(inverse) => inverse.apply(right, x),
            Coarsest::ByRow(blocks) => {
                for ((x, right), block) in x.iter_mut().zip(right).zip(blocks) {
                    *x = std::array::from_fn(|i| {
                        std::array::from_fn(|n| (0..6).map(|j| block[i][j] * right[j][n]).sum())
                    });
                }
            }
        }
    }
}

/// A coarse level with a still coarser one below it.
struct CoarseLevel {
    smoother: Smoother<6>,
    below: Prolongator,
}

/// Work vectors of one cycle, for N right-hand sides.
pub struct Workspace<const N: usize> {
    right: Vec<Lanes<f32, 3, N>>,
    x: Vec<Lanes<f32, 3, N>>,
    rest: Vec<Lanes<f32, 3, N>>,
    coarse: Vec<CoarseWorkspace<N>>,
}

struct CoarseWorkspace<const N: usize> {
    right: Vec<Lanes<f32, 6, N>>,
    x: Vec<Lanes<f32, 6, N>>,
    rest: Vec<Lanes<f32, 6, N>>,
    /// Shares of `right` before they are added.
    partial: Vec<Vec<Lanes<f32, 6, N>>>,
}

impl<const N: usize> CoarseWorkspace<N> {
    fn new(above: &Prolongator, rows: usize) -> Self {
        let zeros = || vec![[[0.0; N]; 6]; rows];
        CoarseWorkspace { right: zeros(), x: zeros(), rest: zeros(), partial: above.partial_sums() }
    }
}

impl Multigrid {
    /// Builds the hierarchy, unless it is stopped.
    pub fn new(system: &System, progress: &dyn Progress) -> Result<Self, SolverError> {
        let special = SpecialRows::new(system);
        let mask = |row: usize, column: usize, block: &mut [[f64; 3]; 3]| {
            special.mask(row, column, block);
        };
        let (finest, below) = rayon::join(
            || Smoother::new(&system.matrix, system.ordering.clone(), mask),
            || CoarseLevels::new(system, &special, progress),
        );
        let partly_constrained = system.partly_constrained.clone();
        Ok(Multigrid { finest, partly_constrained, below: below? })
    }

    pub fn megabytes(&self) -> f64 {
        let CoarseLevels { first, levels, .. } = &self.below;
        let coarse = levels.iter().map(|l| l.smoother.megabytes() + l.below.megabytes());
        self.finest.megabytes() + first.megabytes() + coarse.sum::<f64>()
    }

    pub fn workspace<const N: usize>(&self) -> Workspace<N> {
        let zeros = || vec![[[0.0; N]; 3]; self.finest.rows()];
        let CoarseLevels { first, levels, coarsest_rows, .. } = &self.below;
        let rows = levels.iter().map(|level| level.smoother.rows());
        let above = [first].into_iter().chain(levels.iter().map(|level| &level.below));
        let coarse = above
            .zip(rows.chain([*coarsest_rows]))
            .map(|(above, rows)| CoarseWorkspace::new(above, rows))
            .collect();
        Workspace { right: zeros(), x: zeros(), rest: zeros(), coarse }
    }

    /// One V cycle from zero for each right-hand side: the answer approximates K^-1 `residual`, times
    /// `scale` for each right-hand side.
    pub fn apply<'w, const N: usize>(
        &self,
        residual: &[Lanes<f64, 3, N>],
        workspace: &'w mut Workspace<N>,
    ) -> Correction<'w, N> {
        // f32 holds 38 decades; scaled by its norm, no residual leaves them.
        let scale = norm(residual.as_flattened());
        let inverse = scale.map(|scale| ratio(1.0, scale));
        let chunks = workspace.right.par_chunks_mut(CHUNK).zip(residual.par_chunks(CHUNK));
        chunks.for_each(|(right, residual)| {
            let values = right.as_flattened_mut().iter_mut().zip(residual.as_flattened());
            for (right, residual) in values {
                for n in 0..N {
                    right[n] = (residual[n] * inverse[n]) as f32;
                }
            }
        });
        let Workspace { right, x, rest, coarse } = workspace;
        self.finest.forward(right, x, rest);
        self.partly_constrained.iter().for_each(|row| row.to_coordinates(&mut rest[row.row]));
        let below = &mut coarse[0];
        self.below.first.restrict(rest, &mut below.partial, &mut below.right);
        self.below.descend(0, coarse);
        self.partly_constrained.iter().for_each(|row| row.to_coordinates(&mut x[row.row]));
        self.below.first.add_prolonged(&mut coarse[0].x, x);
        self.partly_constrained.iter().for_each(|row| row.to_own_axes(&mut x[row.row]));
        self.finest.backward(x, right);
        Correction { values: x, scale }
    }
}

impl CoarseLevels {
    fn new(
        system: &System,
        special: &SpecialRows,
        progress: &dyn Progress,
    ) -> Result<Self, SolverError> {
        let free = &system.positions[..system.ordering.free];
        let origin = mean(free);
        check_cancelled(progress)?;
        let strength =
            StrengthOfConnection::new(&system.matrix, &system.ordering, |row| special.axes(row));
        check_cancelled(progress)?;
        let weights = Weights::new(&strength, free, FIRST_AGGREGATE);
        check_cancelled(progress)?;
        let fine = Fine {
            matrix: &system.matrix,
            ordering: &system.ordering,
            positions: free,
            origin,
            turned: |row, column, block: &_| special.to_coordinates(row, column, block),
        };
        let mut current = galerkin(&fine, &weights);
        let mut centres = permuted(&weights.centres, &current.ordering);
        let place = &current.ordering.place;
        let first = weights.into_prolongator(place, free, system.ordering.clone(), &origin);
        let mut levels = Vec::new();
        while current.matrix.rows() > DENSE_ROWS {
            check_cancelled(progress)?;
            let Some((weights, next)) = coarsen(&current, &centres, &origin) else { break };
            let next_centres = permuted(&weights.centres, &next.ordering);
            let ordering = Arc::new(current.ordering);
            let place = &next.ordering.place;
            let below = weights.into_prolongator(place, &centres, ordering.clone(), &origin);
            let smoother = Smoother::new(&current.matrix, ordering, |_, _, _| ());
            levels.push(CoarseLevel { smoother, below });
            centres = next_centres;
            current = next;
        }
        let coarsest_rows = current.matrix.rows();
        let coarsest = match coarsest_rows <= MOST_DENSE_ROWS {
            true => Coarsest::Whole(dense(&current.matrix)),
            false => Coarsest::ByRow(current.matrix.diagonal.iter().map(inverse_block).collect()),
        };
        Ok(CoarseLevels { first, levels, coarsest, coarsest_rows })
    }

    fn descend<const N: usize>(&self, depth: usize, workspace: &mut [CoarseWorkspace<N>]) {
        let Some((own, below)) = workspace.split_first_mut() else { return };
        let Some(level) = self.levels.get(depth) else {
            return self.coarsest.apply(&own.right, &mut own.x);
        };
        level.smoother.forward(&own.right, &mut own.x, &mut own.rest);
        let next = &mut below[0];
        level.below.restrict(&own.rest, &mut next.partial, &mut next.right);
        self.descend(depth + 1, below);
        level.below.add_prolonged(&mut below[0].x, &mut own.x);
        level.smoother.backward(&mut own.x, &mut own.right);
    }
}

fn check_cancelled(progress: &dyn Progress) -> Result<(), SolverError> {
    if progress.is_cancelled() { Err(SolverError::Stopped) } else { Ok(()) }
}

/// Result of a cycle: `values` times `scale` of each right-hand side.
pub struct Correction<'w, const N: usize> {
    pub values: &'w [Lanes<f32, 3, N>],
    pub scale: [f64; N],
}

/// `None` where the rows cannot be grouped any further.
fn coarsen(
    current: &Coarse,
    centres: &[Vector3<f64>],
    origin: &Vector3<f64>,
) -> Option<(Weights, Coarse)> {
    let strength = StrengthOfConnection::new(&current.matrix, &current.ordering, |_| None);
    let weights = Weights::new(&strength, centres, LATER_AGGREGATE);
    if weights.aggregates >= current.matrix.rows() {
        return None;
    }
    let fine = Fine {
        matrix: &current.matrix,
        ordering: &current.ordering,
        positions: centres,
        origin: *origin,
        turned: |_, _, block: &[[f64; 6]; 6]| *block,
    };
    let next = galerkin(&fine, &weights);
    Some((weights, next))
}

fn mean(positions: &[Vector3<f64>]) -> Vector3<f64> {
    positions.iter().sum::<Vector3<f64>>() / positions.len().max(1) as f64
}

fn permuted(
    centres: &[Vector3<f64>],
    ordering: &super::row_ordering::RowOrdering,
) -> Vec<Vector3<f64>> {
    let mut placed = vec![Vector3::zeros(); centres.len()];
    for (centre, &place) in centres.iter().zip(&ordering.place) {
        placed[place as usize] = *centre;
    }
    placed
}

fn dense(matrix: &super::HalfMatrix<f64, 6>) -> DenseInverse {
    let size = 6 * matrix.rows();
    let mut values = vec![0.0; size * size];
    for row in 0..matrix.rows() {
        let mut put = |column: usize, block: &[[f64; 6]; 6]| {
            for i in 0..6 {
                for j in 0..6 {
                    values[(6 * row + i) * size + 6 * column + j] = block[i][j];
                    values[(6 * column + j) * size + 6 * row + i] = block[i][j];
                }
            }
        };
        put(row, &matrix.diagonal[row]);
        matrix.lower_row(row).for_each(|(column, block)| put(column, block));
    }
    DenseInverse::of(values, size)
}

/// The few rows that are partly held or have axes of their own.
struct SpecialRows<'a> {
    rows: &'a [PartlyHeld],
    /// For each free row its entry in `rows`, or `u32::MAX`.
    of_row: Vec<u32>,
}

impl<'a> SpecialRows<'a> {
    fn new(system: &'a System) -> Self {
        let mut of_row = vec![u32::MAX; system.matrix.rows()];
        for (index, partly) in system.partly_constrained.iter().enumerate() {
            of_row[partly.row] = index as u32;
        }
        SpecialRows { rows: &system.partly_constrained, of_row }
    }

    fn of(&self, row: usize) -> Option<&'a PartlyHeld> {
        self.rows.get(self.of_row[row] as usize)
    }

    fn axes(&self, row: usize) -> Option<&'a Matrix3<f64>> {
        self.of(row).map(|partly| &partly.axes)
    }

    /// A block along the axes of the coordinates, with zeros where it is held.
    fn to_coordinates(&self, row: usize, column: usize, block: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let (own, other) = (self.of(row), self.of(column));
        if own.is_none() && other.is_none() {
            return *block;
        }
        let mut masked = *block;
        self.mask(row, column, &mut masked);
        let mut turned = Matrix3::from_fn(|i, j| masked[i][j]);
        if let Some(partly) = own {
            turned = partly.axes * turned;
        }
        if let Some(partly) = other {
            turned *= partly.axes.transpose();
        }
        std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]))
    }

    fn mask(&self, row: usize, column: usize, block: &mut [[f64; 3]; 3]) {
        if let Some(partly) = self.of(row) {
            for (values, held) in block.iter_mut().zip(partly.held) {
                if held {
                    *values = [0.0; 3];
                }
            }
        }
        if let Some(partly) = self.of(column) {
            for (j, _) in partly.held.iter().enumerate().filter(|(_, held)| **held) {
                block.iter_mut().for_each(|values| values[j] = 0.0);
            }
        }
    }
}
