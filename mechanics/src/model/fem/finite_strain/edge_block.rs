//! The block of an edge function in one cell, kept positive definite.
//!
//! The tangent moduli of pressed tissue may let it give way along an edge; its neighbours do not. So a block is at least half as
//! stiff as linear tissue of the same shear modulus in any direction.

use nalgebra::{Matrix3, SymmetricEigen};

/// The least stiffness of an edge, as a share of mu int |grad phi|^2, which is the least one of linear tissue.
pub(super) const LEAST: f64 = 0.5;

/// The block of an edge with nothing softer than a share of `shear` = mu int |grad phi|^2.
pub(super) fn stiff_enough(block: Matrix3<f64>, shear: f64) -> Matrix3<f64> {
    let least = LEAST * shear;
    if (block - Matrix3::from_diagonal_element(least)).cholesky().is_some() {
        return block;
    }
    let mut eigen = SymmetricEigen::new(block);
    eigen.eigenvalues.iter_mut().for_each(|value| *value = value.max(least));
    eigen.recompose()
}
