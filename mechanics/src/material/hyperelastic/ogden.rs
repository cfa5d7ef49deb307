//! Ogden's law, a sum of powers of the principal stretches (Ogden 1972; docs/finite-strain.md#laws).

use super::Derivatives;
use super::volumetric::Volumetric;

/// Terms that a law may have.
pub const MOST_TERMS: usize = 6;

/// mu in kPa, alpha without unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OgdenTerm {
    pub mu: f64,
    pub alpha: f64,
}

/// W = sum_p mu_p/alpha_p (lbar1^alpha_p + lbar2^alpha_p + lbar3^alpha_p - 3) + U(J), lbar = J^-1/3 l; mu at rest is
/// sum_p mu_p alpha_p / 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ogden {
    /// Those that are not used have no mu.
    terms: [OgdenTerm; MOST_TERMS],
    pub volumetric: Volumetric,
}

/// The part of the energy that knows shape alone, and its first and second derivatives by ln lbar_i.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OfStretches {
    pub energy: f64,
    pub first: [f64; 3],
    pub second: [f64; 3],
}

impl Ogden {
    /// The first [`MOST_TERMS`] of these; a term without mu or alpha adds nothing.
    pub fn new(stated: &[OgdenTerm], volumetric: Volumetric) -> Ogden {
        let mut terms = [OgdenTerm::default(); MOST_TERMS];
        let used = stated.iter().filter(|term| term.mu != 0.0 && term.alpha != 0.0);
        terms.iter_mut().zip(used).for_each(|(own, term)| *own = *term);
        Ogden { terms, volumetric }
    }

    pub fn terms(&self) -> impl Iterator<Item = &OgdenTerm> {
        self.terms.iter().filter(|term| term.mu != 0.0)
    }

    /// Of the volume alone.
    #[inline]
    pub(super) fn of_volume(&self, j: f64) -> Derivatives {
        let u = self.volumetric.at(j);
        Derivatives { energy: u.energy, by_j: u.first, by_j_j: u.second, ..Derivatives::default() }
    }

    /// Of stretches whose product is 1.
    pub(super) fn at(&self, stretches: [f64; 3]) -> OfStretches {
        let mut sum = OfStretches::default();
        for OgdenTerm { mu, alpha } in self.terms() {
            for (i, stretch) in stretches.iter().enumerate() {
                let power = stretch.powf(*alpha);
                sum.energy += mu / alpha * (power - 1.0);
                sum.first[i] += mu * power;
                sum.second[i] += mu * alpha * power;
            }
        }
        sum
    }
}
