//! Fibres that only pull, beside any law of the tissue between them (Holzapfel, Gasser, Ogden 2000, with the whole invariant I4 of
//! Nolan et al. 2014 in place of its isochoric part: docs/finite-strain.md#laws).

use super::exponential::exponential;

/// W = k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) where I4 > 1, nothing elsewhere: k1 in kPa, k2 without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibres {
    pub k1: f64,
    pub k2: f64,
}

/// W and its derivatives by I4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfStretch {
    pub energy: f64,
    pub first: f64,
    pub second: f64,
}

impl Fibres {
    /// For the squared stretch along the fibres.
    #[inline]
    pub fn at(&self, i4: f64) -> OfStretch {
        let x = i4 - 1.0;
        if x <= 0.0 {
            return OfStretch::default();
        }
        let grown = exponential(self.exponent(i4));
        OfStretch {
            energy: 0.5 * self.k1 / self.k2 * (grown.value - 1.0),
            first: self.k1 * x * grown.first,
            second: self.k1 * (grown.first + 2.0 * self.k2 * x * x * grown.second),
        }
    }

    /// k2 (I4 - 1)^2 where the fibres pull.
    #[inline]
    pub fn exponent(&self, i4: f64) -> f64 {
        self.k2 * (i4 - 1.0).max(0.0).powi(2)
    }
}
