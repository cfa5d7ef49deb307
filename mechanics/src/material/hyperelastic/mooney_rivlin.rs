//! Mooney-Rivlin as a polynomial of second degree (docs/finite-strain.md#laws).

use super::isochoric::{OfShape, split};
use super::volumetric::Volumetric;
use super::{Derivatives, Invariants};

/// W = c10 (Ibar1 - 3) + c01 (Ibar2 - 3) + c20 (Ibar1 - 3)^2 + c11 (Ibar1 - 3)(Ibar2 - 3) + c02 (Ibar2 - 3)^2 + U(J), in
/// kPa; mu at rest is 2 (c10 + c01).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MooneyRivlin {
    pub c10: f64,
    pub c01: f64,
    pub c20: f64,
    pub c11: f64,
    pub c02: f64,
    pub volumetric: Volumetric,
}

impl MooneyRivlin {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        split(at, self.volumetric, |shape| {
            let (x, y) = (shape.i1 - 3.0, shape.i2 - 3.0);
            OfShape {
                energy: (self.c10 + self.c20 * x + self.c11 * y) * x
                    + (self.c01 + self.c02 * y) * y,
                by_1: self.c10 + 2.0 * self.c20 * x + self.c11 * y,
                by_2: self.c01 + self.c11 * x + 2.0 * self.c02 * y,
                by_1_1: 2.0 * self.c20,
                by_1_2: self.c11,
                by_2_2: 2.0 * self.c02,
            }
        })
    }
}
