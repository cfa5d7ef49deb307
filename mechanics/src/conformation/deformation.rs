//! The map from a template to a patient: an affine map, and a free-form deformation after it.

use nalgebra::Matrix3;

use super::affine::Affine;
use super::lattice::Field;
use crate::mesh::Vector;

/// x -> y + u(y) with y = A x + b, in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformation {
    pub affine: Affine,
    pub(super) field: Field,
}

impl Deformation {
    pub fn apply(&self, point: &Vector) -> Vector {
        let moved = self.affine.apply(point);
        moved + self.field.at(&moved)
    }

    /// ∂f/∂x.
    pub fn gradient(&self, point: &Vector) -> Matrix3<f64> {
        let moved = self.affine.apply(point);
        (Matrix3::identity() + self.field.gradient(&moved)) * self.affine.matrix
    }
}
