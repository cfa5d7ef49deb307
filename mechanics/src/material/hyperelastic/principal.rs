//! Stress and tangent in principal axes, for energies that are stated in principal stretches.
//!
//! With C = sum_i l_i^2 n_i n_i^T, t_i = F n_i and tau_i = dW / d(ln l_i), the second Piola-Kirchhoff stress is
//! S_i = tau_i / l_i^2 along n_i, and the derivatives of V F S g_a by u_b are, for each unit of volume,
//!   (g_a . S g_b) I + sum_ij A_ij (n_i . g_a)(n_j . g_b) t_i t_j^T
//!     + sum_(i != j) T_ij [ (n_j . g_a)(n_j . g_b) t_i t_i^T + (n_j . g_a)(n_i . g_b) t_i t_j^T ],
//! A_ij = 2 dS_i / d(l_j^2), T_ij = (S_i - S_j) / (l_i^2 - l_j^2), whose limit for equal stretches is (A_ii - A_ij) / 2
//! (Ogden 1984, section 6.1.4; docs/methods.md#hyperelastic-laws).

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::ogden::Ogden;

/// Squared stretches nearer to each other than this, relative to their sum, are taken for equal: what the limit leaves out is
/// of second order in their distance, and what rounding does to a quotient grows with its inverse.
const EQUAL: f64 = 1e-5;

/// The part of a point that is stated in stretches.
#[derive(Clone, Debug)]
pub(super) struct Principal {
    pub energy: f64,
    /// S, in kPa.
    pub second_stress: Matrix3<f64>,
    /// n_i and t_i, in columns.
    axes: Matrix3<f64>,
    turned: Matrix3<f64>,
    /// A and T, in kPa.
    normal: Matrix3<f64>,
    shear: Matrix3<f64>,
}

impl Principal {
    pub fn new(law: &Ogden, f: &Matrix3<f64>, j: f64) -> Principal {
        let SymmetricEigen { eigenvalues: squares, eigenvectors: axes } =
            SymmetricEigen::new(f.transpose() * f);
        let shrink = j.cbrt().recip();
        let of_shape = law.at(std::array::from_fn(|i| shrink * squares[i].sqrt()));
        let [first, second] = [of_shape.first, of_shape.second].map(Vector3::from);
        // Stretches of shape are those of the tissue without the mean of their logarithms.
        let tau = first.add_scalar(-first.mean());
        let bend = Matrix3::from_fn(|i, k| {
            let own = if i == k { second[i] } else { 0.0 };
            own - (second[i] + second[k]) / 3.0 + second.sum() / 9.0
        });
        let stress = tau.component_div(&squares);
        let normal = Matrix3::from_fn(|i, k| {
            let own = if i == k { 2.0 * tau[i] } else { 0.0 };
            (bend[(i, k)] - own) / (squares[i] * squares[k])
        });
        let shear = Matrix3::from_fn(|i, k| {
            let apart = squares[i] - squares[k];
            match apart.abs() > EQUAL * (squares[i] + squares[k]) {
                true => (stress[i] - stress[k]) / apart,
                false => 0.25 * (normal[(i, i)] + normal[(k, k)]) - 0.5 * normal[(i, k)],
            }
        });
        let second_stress = axes * Matrix3::from_diagonal(&stress) * axes.transpose();
        let turned = f * axes;
        Principal { energy: of_shape.energy, second_stress, axes, turned, normal, shear }
    }

    /// d2W / du_a du_b for the gradients of two shape functions at rest, for each unit of volume.
    pub fn block(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
        let (own, other) = (self.axes.tr_mul(a), self.axes.tr_mul(b));
        let mut inner = Matrix3::zeros();
        for i in 0..3 {
            for k in 0..3 {
                inner[(i, k)] += self.normal[(i, k)] * own[i] * other[k];
                if i != k {
                    let shear = self.shear[(i, k)] * own[k];
                    inner[(i, i)] += shear * other[k];
                    inner[(i, k)] += shear * other[i];
                }
            }
        }
        let along = a.dot(&(self.second_stress * b));
        self.turned * inner * self.turned.transpose() + Matrix3::from_diagonal_element(along)
    }
}
