//! Fung's law, exponential in shape and alike in all directions (Fung 1967, Demiray 1972; docs/finite-strain.md#laws).

use super::exponential::exponential;
use super::isochoric::{OfShape, split};
use super::volumetric::Volumetric;
use super::{Derivatives, Invariants};

/// W = mu/(2b) (exp(b (Ibar1 - 3)) - 1) + U(J): mu in kPa, b without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fung {
    pub mu: f64,
    pub b: f64,
    pub volumetric: Volumetric,
}

impl Fung {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        split(at, self.volumetric, |shape| {
            let grown = exponential(self.b * (shape.i1 - 3.0));
            OfShape {
                energy: 0.5 * self.mu / self.b * (grown.value - 1.0),
                by_1: 0.5 * self.mu * grown.first,
                by_1_1: 0.5 * self.mu * self.b * grown.second,
                ..OfShape::default()
            }
        })
    }
}
