//! Shape functions, their gradients and quadrature weights at the points of a reference cell.

use nalgebra::{Matrix3, Vector3};

pub(super) type Vector = Vector3<f64>;

/// The most nodes a cell has.
pub const MAX_NODES: usize = 8;

/// Shape functions of one cell shape at the points of its quadrature rule and at its centre.
pub struct ReferenceCell {
    pub node_count: usize,
    pub points: Vec<ReferencePoint>,
    pub centre: ReferencePoint,
}

/// Values and reference gradients of all shape functions at one point; unused entries are zero.
#[derive(Clone, Debug)]
pub struct ReferencePoint {
    pub weight: f64,
    pub values: [f64; MAX_NODES],
    pub gradients: [Vector; MAX_NODES],
}

/// Gradients with respect to position, in 1/mm, and the volume in mm³ that the point stands for.
#[derive(Clone, Debug)]
pub struct PhysicalPoint {
    pub gradients: [Vector; MAX_NODES],
    pub volume: f64,
}

impl ReferencePoint {
    /// What takes reference gradients to those in a cell with these corners, J^-T in 1/mm, and the volume in mm³ that the point stands
    /// for; `None` where the cell is inverted or flat there.
    pub fn to_cell(&self, corners: &[Vector]) -> Option<(Matrix3<f64>, f64)> {
        let jacobian = corners
            .iter()
            .zip(&self.gradients)
            .fold(Matrix3::zeros(), |sum: Matrix3<f64>, (corner, gradient)| {
                sum + corner * gradient.transpose()
            });
        let determinant = jacobian.determinant();
        if determinant.is_nan() || determinant <= 0.0 {
            return None;
        }
        Some((jacobian.try_inverse()?.transpose(), self.weight * determinant))
    }

    /// The point in a cell with these corners; `None` where the cell is inverted or flat there.
    pub fn at(&self, corners: &[Vector]) -> Option<PhysicalPoint> {
        let (to_cell, volume) = self.to_cell(corners)?;
        let gradients = self.gradients.map(|gradient| to_cell * gradient);
        Some(PhysicalPoint { gradients, volume })
    }

    /// Where the point is in a cell with these corners.
    pub fn position(&self, corners: &[Vector]) -> Vector {
        corners.iter().zip(&self.values).map(|(corner, value)| corner * *value).sum()
    }
}

/// The Gauss points of two-point quadrature on [-1, 1] lie at plus and minus this.
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;
