//! Ogden's compressible law with a logarithmic barrier, in its polyconvex form (Ciarlet 1988; Zachow et al.
//! 2006, section 4.1; docs/finite-strain.md#laws).
//!
//! It agrees with Saint Venant-Kirchhoff to second order at rest, and no finite energy turns tissue inside out.

use super::{Derivatives, Invariants};

/// W = a2 (I1 - 3) + b2 (I2 - 3) + c2 (J^2 - 1) - (mu + lambda/2) ln J, a2 = mu/2 - b2, c2 = lambda/4 - b2, in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolyconvexBarrier {
    pub lambda: f64,
    pub mu: f64,
}

impl PolyconvexBarrier {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        let Invariants { i1, i2, j } = *at;
        // The middle of the range in which all of a2, b2 and c2 are positive; none is without lambda.
        let b2 = 0.5 * (0.5 * self.mu).min(0.25 * self.lambda).max(0.0);
        let (a2, c2) = (0.5 * self.mu - b2, 0.25 * self.lambda - b2);
        let barrier = self.mu + 0.5 * self.lambda;
        Derivatives {
            energy: a2 * (i1 - 3.0) + b2 * (i2 - 3.0) + c2 * (j * j - 1.0) - barrier * j.ln(),
            by_i1: a2,
            by_i2: b2,
            by_j: 2.0 * c2 * j - barrier / j,
            by_j_j: 2.0 * c2 + barrier / (j * j),
            ..Derivatives::default()
        }
    }
}
