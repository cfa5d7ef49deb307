//! The rules by which moduli of parts become those of a mixture: means of a function of them, by the shares of their volume.
//!
//! Source: Voigt 1889, Reuss 1929; the mean of logarithms lies between both and is the same for stiffness and compliance
//! (Matthies, Humbert 1995).

use nalgebra::Matrix2;

/// The rule by which moduli of parts become those of a mixture, in the shares of their volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MixingRule {
    /// Parts strained alike: the arithmetic mean, the stiffest that shares allow.
    #[default]
    Voigt,
    /// Parts stressed alike: the harmonic mean, the softest.
    Reuss,
    /// The geometric mean, between both and bound to no arrangement of the parts.
    Geometric,
}

impl MixingRule {
    /// The mean of positive numbers, each with its share; shares sum to 1.
    pub(super) fn mean(self, terms: impl Iterator<Item = (f64, f64)>) -> f64 {
        self.back(terms.map(|(share, value)| share * self.of(value)).sum())
    }

    /// The mean of symmetric positive definite matrices.
    pub(super) fn matrix_mean(
        self,
        terms: impl Iterator<Item = (f64, Matrix2<f64>)>,
    ) -> Matrix2<f64> {
        let of = |value| self.of(value);
        let sum = terms.map(|(share, matrix)| by_eigenvalues(&matrix, of) * share).sum();
        by_eigenvalues(&sum, |value| self.back(value))
    }

    /// What the rule takes the arithmetic mean of.
    fn of(self, value: f64) -> f64 {
        match self {
            MixingRule::Voigt => value,
            MixingRule::Reuss => 1.0 / value,
            MixingRule::Geometric => value.ln(),
        }
    }

    fn back(self, mean: f64) -> f64 {
        match self {
            MixingRule::Voigt => mean,
            MixingRule::Reuss => 1.0 / mean,
            MixingRule::Geometric => mean.exp(),
        }
    }
}

/// A function of a symmetric matrix, by Jacobi's rotation, which leaves the smaller of two eigenvalues its digits.
fn by_eigenvalues(matrix: &Matrix2<f64>, function: impl Fn(f64) -> f64) -> Matrix2<f64> {
    let (a, b, c) = (matrix[(0, 0)], matrix[(0, 1)], matrix[(1, 1)]);
    let tangent = if b == 0.0 {
        0.0
    } else {
        let cotangent = (c - a) / (2.0 * b);
        cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0))
    };
    let [first, second] = [a - tangent * b, c + tangent * b].map(function);
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    let beside = (second - first) * sine * cosine;
    Matrix2::new(
        first * cosine * cosine + second * sine * sine,
        beside,
        beside,
        first * sine * sine + second * cosine * cosine,
    )
}
