//! Veronda and Westmann's law of skin, exponential in shape (Veronda, Westmann 1970; docs/finite-strain.md#laws).

use super::exponential::exponential;
use super::isochoric::{OfShape, split};
use super::volumetric::Volumetric;
use super::{Derivatives, Invariants};

/// W = c1 (exp(g (Ibar1 - 3)) - 1) - c1 g/2 (Ibar2 - 3) + U(J): c1 in kPa, g without unit; mu at rest is c1 g.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerondaWestmann {
    pub c1: f64,
    pub g: f64,
    pub volumetric: Volumetric,
}

impl VerondaWestmann {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        split(at, self.volumetric, |shape| {
            let grown = exponential(self.g * (shape.i1 - 3.0));
            OfShape {
                energy: self.c1 * (grown.value - 1.0) - 0.5 * self.c1 * self.g * (shape.i2 - 3.0),
                by_1: self.c1 * self.g * grown.first,
                by_2: -0.5 * self.c1 * self.g,
                by_1_1: self.c1 * self.g * self.g * grown.second,
                ..OfShape::default()
            }
        })
    }
}
