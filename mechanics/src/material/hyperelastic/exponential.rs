//! The exponential of the laws of Fung, Veronda and Westmann, and of fibres, continued where it would grow beyond all bounds.

/// Beyond this exponent the exponential goes on as a parabola with the same value, slope and curvature
/// (docs/finite-strain.md#laws).
pub const LARGEST_EXPONENT: f64 = 30.0;

/// e^x with its first two derivatives, all of them continuous.
#[derive(Clone, Copy)]
pub(super) struct Exponential {
    pub value: f64,
    pub first: f64,
    pub second: f64,
}

#[inline]
pub(super) fn exponential(x: f64) -> Exponential {
    let value = x.min(LARGEST_EXPONENT).exp();
    let beyond = (x - LARGEST_EXPONENT).max(0.0);
    Exponential {
        value: value * (1.0 + beyond + 0.5 * beyond * beyond),
        first: value * (1.0 + beyond),
        second: value,
    }
}
