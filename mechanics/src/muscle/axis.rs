//! Means of axes, whose sign does not matter.

use nalgebra::Matrix3;

use crate::mesh::Vector;

/// Above this ratio of the second to the first eigenvalue the axes of a cell have no common direction.
pub const CROSSING: f64 = 0.5;

/// The leading eigenvector of Σ w a aᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanAxis {
    /// Of length 1, sign free.
    pub direction: Vector,
    /// Of the second to the first eigenvalue: 0 where all axes are parallel, 1 where two cross at right angles alike.
    pub crossing: f64,
}

impl MeanAxis {
    /// Of a sum Σ w a aᵀ; nothing where it is zero.
    pub fn of(sum: &Matrix3<f64>) -> Option<Self> {
        if sum.trace() <= 0.0 {
            return None;
        }
        let (values, vectors) = principal(sum);
        Some(MeanAxis { direction: vectors[0], crossing: (values[1] / values[0]).max(0.0) })
    }

    /// Whether fibres cross in it, so that one axis does not stand for them.
    pub fn is_crossing(&self) -> bool {
        self.crossing > CROSSING
    }
}

/// The mean of weighted axes: of several muscles in a cell, or of vectors at its nodes with equal weights. Their lengths do not
/// matter; nothing where none has both a length and a weight above 0.
pub fn mean_axis(axes: impl IntoIterator<Item = (f64, Vector)>) -> Option<MeanAxis> {
    let mut sum = Matrix3::zeros();
    for (weight, axis) in axes {
        let length = axis.norm();
        if weight > 0.0 && length > 0.0 && length.is_finite() {
            let unit = axis / length;
            sum += unit * unit.transpose() * weight;
        }
    }
    MeanAxis::of(&sum)
}

/// Eigenvalues of a symmetric matrix, the largest first, and their unit vectors.
pub(super) fn principal(matrix: &Matrix3<f64>) -> ([f64; 3], [Vector; 3]) {
    let modes = matrix.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| modes.eigenvalues[b].total_cmp(&modes.eigenvalues[a]));
    let vector = |place: usize| modes.eigenvectors.column(place).into_owned();
    (order.map(|place| modes.eigenvalues[place]), order.map(vector))
}
