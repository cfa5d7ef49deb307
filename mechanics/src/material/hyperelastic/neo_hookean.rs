//! Neo-Hookean: the default at finite strain, from Young's modulus and Poisson's ratio alone.

use super::isochoric::{OfShape, split};
use super::volumetric::Volumetric;
use super::{Derivatives, Invariants};

/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J, in kPa (Kim et al. 2012, table 1, with its constant corrected:
/// docs/methods.md#corrections).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    pub lambda: f64,
    pub mu: f64,
}

impl NeoHookean {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        let log = at.j.ln();
        let pressure = self.lambda * log - self.mu;
        Derivatives {
            energy: 0.5 * self.mu * (at.i1 - 3.0) - self.mu * log + 0.5 * self.lambda * log * log,
            by_i1: 0.5 * self.mu,
            by_j: pressure / at.j,
            by_j_j: (self.lambda - pressure) / (at.j * at.j),
            ..Derivatives::default()
        }
    }
}

/// W = mu/2 (Ibar1 - 3) + U(J), in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookeanIsochoric {
    pub mu: f64,
    pub volumetric: Volumetric,
}

impl NeoHookeanIsochoric {
    #[inline]
    pub(super) fn at(&self, at: &Invariants) -> Derivatives {
        split(at, self.volumetric, |shape| OfShape {
            energy: 0.5 * self.mu * (shape.i1 - 3.0),
            by_1: 0.5 * self.mu,
            ..OfShape::default()
        })
    }
}
