//! Taylor coefficients at rest of the first Piola-Kirchhoff stress, of neo-Hookean tissue with fibres.
//!
//! Along F = I + H, isotropic tissue has P = mu (F - F^-T) + tau F^-T with a tension tau that is lambda ln J, a pressure, or
//! a mean over a cell, and with tau = tau1 + tau2 + tau3 + ... by order in H
//!   first:  mu (H + H^T) + tau1 I
//!   second: -mu (H^T)^2 + tau2 I - tau1 H^T
//!   third:  mu (H^T)^3 + tau3 I - tau2 H^T + tau1 (H^T)^2
//!   ln J = tr H - tr H^2 / 2 + tr H^3 / 3 - ...
//! (F^-T = I - H^T + (H^T)^2 - ...; the law is `hyperelastic::neo_hookean`). What fibres add to the
//! stiffness is taken as a quadratic energy of Green's strain, so that turning strains nothing: P = F C:E,
//! E = (H + H^T + H^T H) / 2. The first orders are those of linear elasticity.

use nalgebra::Matrix3;

use super::elastic_tensor::ElasticTensor;

/// A displacement gradient H, and its first-order tension in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub gradient: Matrix3<f64>,
    pub tension: f64,
}

/// The bilinear form of the second order of ln J: -tr (G H) / 2.
#[inline]
pub fn second_log_volume(g: &Matrix3<f64>, h: &Matrix3<f64>) -> f64 {
    -0.5 * g.dot(&h.transpose())
}

/// The bilinear form of the second order of J: (tr G tr H - tr (G H)) / 2.
#[inline]
pub fn second_volume(g: &Matrix3<f64>, h: &Matrix3<f64>) -> f64 {
    0.5 * g.trace() * h.trace() + second_log_volume(g, h)
}

/// The third order of ln J: tr H^3 / 3.
#[inline]
pub fn third_log_volume(h: &Matrix3<f64>) -> f64 {
    (h * h).dot(&h.transpose()) / 3.0
}

/// The symmetric bilinear form of the second order of P in kPa; `tension` is that of tau2 for the two.
#[inline]
pub fn second_stress(mu: f64, [a, b]: [&Stretch; 2], tension: f64) -> Matrix3<f64> {
    let (g, h) = (&a.gradient, &b.gradient);
    // The transposes of G^T H^T + H^T G^T and of the others.
    let twice = (h * g + g * h) * mu + h * a.tension + g * b.tension;
    Matrix3::from_diagonal_element(tension) - twice.transpose() * 0.5
}

/// The third order of P in kPa along one H; `second` and `third` are tau2 and tau3.
#[inline]
pub fn third_stress(mu: f64, a: &Stretch, second: f64, third: f64) -> Matrix3<f64> {
    let h = &a.gradient;
    let square = h * h;
    let transposed = square * h * mu + square * a.tension - h * second;
    Matrix3::from_diagonal_element(third) + transposed.transpose()
}

/// The symmetric bilinear form of the second order of F C:E.
pub fn second_green_stress(
    stiffness: &ElasticTensor,
    g: &Matrix3<f64>,
    h: &Matrix3<f64>,
) -> Matrix3<f64> {
    let of = |h: &Matrix3<f64>| stiffness.stress(&((h + h.transpose()) * 0.5));
    let product = g.transpose() * h;
    let strain = (product + product.transpose()) * 0.25;
    (g * of(h) + h * of(g)) * 0.5 + stiffness.stress(&strain)
}

/// The third order of F C:E along one H.
pub fn third_green_stress(stiffness: &ElasticTensor, h: &Matrix3<f64>) -> Matrix3<f64> {
    h * stiffness.stress(&(h.transpose() * h * 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::elastic_tensor::{AlongFibre, FibreModuli};
    use crate::material::hyperelastic::point::Point;
    use crate::material::hyperelastic::{Law, NeoHookean};

    const LAMBDA: f64 = 40.0;
    const MU: f64 = 5.0;

    fn sheared() -> Matrix3<f64> {
        Matrix3::new(0.3, -0.5, 0.2, 0.7, 0.1, -0.4, -0.2, 0.6, -0.3)
    }

    fn stretch(gradient: Matrix3<f64>) -> Stretch {
        Stretch { gradient, tension: LAMBDA * gradient.trace() }
    }

    /// P(I + s H) less its first two orders, over s^3.
    fn third_order_remainder(s: f64) -> Matrix3<f64> {
        let h = sheared();
        let law = Law::NeoHookean(NeoHookean { lambda: LAMBDA, mu: MU });
        let stress = Point::new(&law, None, Matrix3::identity() + h * s).stress();
        let first = (h + h.transpose()) * MU + Matrix3::identity() * (LAMBDA * h.trace());
        let tension = LAMBDA * second_log_volume(&h, &h);
        let second = second_stress(MU, [&stretch(h), &stretch(h)], tension);
        (stress - first * s - second * (s * s)) / s.powi(3)
    }

    #[test]
    fn the_stress_of_a_point_is_its_series_up_to_the_fourth_order() {
        let h = sheared();
        let tensions = [second_log_volume(&h, &h), third_log_volume(&h)].map(|log| LAMBDA * log);
        let third = third_stress(MU, &stretch(h), tensions[0], tensions[1]);
        let off = |s: f64| (third_order_remainder(s) - third).norm() / third.norm();
        assert!(off(1e-2) < 0.05, "{}", off(1e-2));
        let ratio = off(1e-2) / off(5e-3);
        assert!((1.9..2.1).contains(&ratio), "{ratio}");
    }

    #[test]
    fn the_second_order_is_symmetric_in_its_two_gradients() {
        let (g, h) = (stretch(sheared()), stretch(sheared().transpose() * sheared()));
        let apart = second_stress(MU, [&g, &h], 1.0) - second_stress(MU, [&h, &g], 1.0);
        assert!(apart.norm() < 1e-14, "{apart}");
    }

    #[test]
    fn stress_along_fibres_is_the_series_of_a_stiffness_of_greens_strain() {
        let moduli = FibreModuli { delta_lambda: 3.0, delta_mu: 7.0, beta: 20.0 };
        let direction = nalgebra::Vector3::new(0.6, 0.0, 0.8);
        let fibre = Some(AlongFibre { direction, moduli });
        let tensor = ElasticTensor { lambda: LAMBDA, mu: MU, fibre };
        let h = sheared();
        let sum = second_green_stress(&tensor, &h, &h) + third_green_stress(&tensor, &h);
        let f = Matrix3::identity() + h;
        let strain = (f.transpose() * f - Matrix3::identity()) * 0.5;
        let first = tensor.stress(&((h + h.transpose()) * 0.5));
        let apart = f * tensor.stress(&strain) - first - sum;
        assert!(apart.norm() < 1e-12, "{apart}");
    }
}
