//! Saint Venant-Kirchhoff: W = lambda/2 (tr E)^2 + mu tr E^2, E = (C - I)/2 (docs/finite-strain.md#laws).
//!
//! Tissue that is pressed to less than .577 of its length gives way: never chosen unasked.

use super::{Derivatives, Invariants};

/// In kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff {
    pub lambda: f64,
    pub mu: f64,
}

impl SaintVenantKirchhoff {
    /// With tr E = (I1 - 3)/2 and tr E^2 = (I1^2 - 2 I2 - 2 I1 + 3)/4.
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        let Invariants { i1, i2, .. } = *at;
        let squares = 0.25 * (i1 * i1 - 2.0 * i2 - 2.0 * i1 + 3.0);
        Derivatives {
            energy: 0.125 * self.lambda * (i1 - 3.0).powi(2) + self.mu * squares,
            by_i1: 0.25 * self.lambda * (i1 - 3.0) + 0.5 * self.mu * (i1 - 1.0),
            by_i2: -0.5 * self.mu,
            by_i1_i1: 0.25 * self.lambda + 0.5 * self.mu,
            ..Derivatives::default()
        }
    }
}
