//! The exact solve on the coarsest level.

use nalgebra::{DMatrix, DVector};

use super::rows::{BlockRows, CoarseMatrix};

/// Directions whose eigenvalue is below this share of the largest one do nothing and get nothing.
const SINGULAR: f64 = 1e-10;

/// The inverse of a small symmetric matrix on the directions in which it is definite.
pub(super) struct DenseInverse {
    inverse: DMatrix<f64>,
}

impl DenseInverse {
    pub fn of(matrix: &CoarseMatrix) -> Self {
        let size = 6 * matrix.rows();
        let mut dense = DMatrix::zeros(size, size);
        for row in 0..matrix.rows() {
            for (column, block) in matrix.row(row) {
                for (i, values) in block.iter().enumerate() {
                    for (j, value) in values.iter().enumerate() {
                        dense[(6 * row + i, 6 * column + j)] = *value;
                    }
                }
            }
        }
        // Rotations and translations differ in unit: the diagonal scales them alike.
        let scale = DVector::from_fn(size, |i, _| {
            if dense[(i, i)] > 0.0 { dense[(i, i)].sqrt().recip() } else { 0.0 }
        });
        let scaled = DMatrix::from_fn(size, size, |i, j| dense[(i, j)] * scale[i] * scale[j]);
        let mut eigen = scaled.symmetric_eigen();
        let least = SINGULAR * eigen.eigenvalues.amax();
        eigen.eigenvalues.apply(|value| *value = if *value > least { 1.0 / *value } else { 0.0 });
        let inverse = eigen.recompose();
        DenseInverse {
            inverse: DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * scale[i] * scale[j]),
        }
    }

    pub fn apply(&self, residual: &[f32]) -> Vec<f32> {
        let residual =
            DVector::from_iterator(residual.len(), residual.iter().map(|r| f64::from(*r)));
        (&self.inverse * residual).iter().map(|value| *value as f32).collect()
    }
}
