//! Affine maps of space, and the least-squares map of attracted points to their targets.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::pull::Pull;
use crate::mesh::Vector;

/// What is added to the normal equations, as a share of their mean diagonal: directions that nothing holds stay.
const DAMPING: f64 = 1e-9;

/// x -> matrix x + shift, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    pub matrix: Matrix3<f64>,
    pub shift: Vector,
}

impl Affine {
    pub fn identity() -> Self {
        Affine { matrix: Matrix3::identity(), shift: Vector::zeros() }
    }

    pub fn apply(&self, point: &Vector) -> Vector {
        self.matrix * point + self.shift
    }

    /// This map, and `next` after it.
    pub fn then(&self, next: &Affine) -> Affine {
        Affine { matrix: next.matrix * self.matrix, shift: next.matrix * self.shift + next.shift }
    }

    /// The affine map of least weighted squares, of which a share `stiffness` of the pulls' weight keeps it from
    /// shearing and stretching.
    pub(super) fn fitted(pulls: &[Pull], stiffness: f64) -> Option<Affine> {
        let total: f64 = pulls.iter().map(Pull::weight).sum();
        let middle = pulls.iter().map(|pull| pull.at * pull.weight()).sum::<Vector>() / total;
        let spread: f64 =
            pulls.iter().map(|pull| pull.weight() * (pull.at - middle).norm_squared()).sum();
        let radius = (spread / total).sqrt().max(f64::MIN_POSITIVE);
        let mut matrix = SMatrix::<f64, 12, 12>::zeros();
        let mut right = SVector::<f64, 12>::zeros();
        for pull in pulls {
            let local = (pull.at - middle) / radius;
            let basis = [local.x, local.y, local.z, 1.0];
            let (hold, force) = (pull.stiffness(), pull.stiffness() * (pull.to - pull.at));
            for (a, one) in basis.iter().enumerate() {
                for (b, other) in basis.iter().enumerate() {
                    let mut block = matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                    block += hold * (one * other);
                }
                let mut part = right.fixed_rows_mut::<3>(3 * a);
                part += force * *one;
            }
        }
        let damping = DAMPING * matrix.trace() / 12.0;
        for place in 0..12 {
            matrix[(place, place)] += damping + if place < 9 { stiffness * total } else { 0.0 };
        }
        let solution = matrix.cholesky()?.solve(&right);
        let column = |place: usize| solution.fixed_rows::<3>(3 * place).into_owned();
        let slope = Matrix3::from_columns(&[column(0), column(1), column(2)]) / radius;
        let matrix = Matrix3::identity() + slope;
        Some(Affine { matrix, shift: column(3) - slope * middle })
    }
}
