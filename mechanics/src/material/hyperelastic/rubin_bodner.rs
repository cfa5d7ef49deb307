//! The elastic part of Rubin and Bodner's law of facial tissue, exponential in shape and volume at once (Rubin, Bodner 2002;
//! Zhang et al. 2016, equations 1 to 5, corrected: docs/methods.md#corrections).

use super::exponential::exponential;
use super::{Derivatives, Invariants};

/// W = eps0/(2p) (exp(p t) - 1), t = 2 eta1 (J - 1 - ln J) + theta eta2 (Ibar1 - 3): eps0 in kPa, the others without unit.
/// At rest K = eps0 eta1 and mu = theta eps0 eta2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RubinBodner {
    pub eps0: f64,
    pub p: f64,
    pub eta1: f64,
    pub eta2: f64,
    /// Of a class of surgery.
    pub theta: f64,
}

impl RubinBodner {
    /// p t.
    #[inline]
    pub(super) fn exponent(&self, at: &Invariants) -> f64 {
        let shape = at.j.cbrt().powi(-2) * at.i1 - 3.0;
        let t = 2.0 * self.eta1 * (at.j - 1.0 - at.j.ln()) + self.theta * self.eta2 * shape;
        self.p * t
    }

    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        let Invariants { i1, j, .. } = *at;
        let grown = exponential(self.exponent(at));
        let (mu, per) = (self.theta * self.eta2, j.cbrt().powi(-2));
        // Of t by I1 and J.
        let by_1 = mu * per;
        let by_j = 2.0 * self.eta1 * (1.0 - 1.0 / j) - 2.0 / 3.0 * mu * per * i1 / j;
        let by_1_j = -2.0 / 3.0 * mu * per / j;
        let by_j_j = (2.0 * self.eta1 + 10.0 / 9.0 * mu * per * i1) / (j * j);
        let (first, second) =
            (0.5 * self.eps0 * grown.first, 0.5 * self.eps0 * self.p * grown.second);
        Derivatives {
            energy: 0.5 * self.eps0 / self.p * (grown.value - 1.0),
            by_i1: first * by_1,
            by_j: first * by_j,
            by_i1_i1: second * by_1 * by_1,
            by_i1_j: second * by_1 * by_j + first * by_1_j,
            by_j_j: second * by_j * by_j + first * by_j_j,
            ..Derivatives::default()
        }
    }
}
