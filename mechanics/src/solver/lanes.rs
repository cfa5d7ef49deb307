//! Unknowns of one row for one or several right-hand sides, and their product with a block.

use std::ops::{AddAssign, Mul, Neg};

/// B components of N right-hand sides: the N values of a component lie side by side, for the
/// vector units of the processor.
pub type Lanes<T, const B: usize, const N: usize> = [[T; N]; B];

/// f32 and f64.
pub trait Real:
    Copy + Default + Send + Sync + AddAssign + Mul<Output = Self> + Neg<Output = Self>
{
}

impl Real for f32 {}
impl Real for f64 {}

/// sum += A x.
#[inline(always)]
pub(super) fn add_product<T: Real, const B: usize, const N: usize>(
    sum: &mut Lanes<T, B, N>,
    block: &[[T; B]; B],
    x: &Lanes<T, B, N>,
) {
    for r in 0..B {
        for c in 0..B {
            for n in 0..N {
                sum[r][n] += block[r][c] * x[c][n];
            }
        }
    }
}

/// sum += A^T x.
#[inline(always)]
pub(super) fn add_transposed<T: Real, const B: usize, const N: usize>(
    sum: &mut Lanes<T, B, N>,
    block: &[[T; B]; B],
    x: &Lanes<T, B, N>,
) {
    for r in 0..B {
        for c in 0..B {
            for n in 0..N {
                sum[c][n] += block[r][c] * x[r][n];
            }
        }
    }
}

/// Exact, like every change of sign.
#[inline(always)]
pub(super) fn negated<T: Real, const B: usize, const N: usize>(
    x: &Lanes<T, B, N>,
) -> Lanes<T, B, N> {
    x.map(|component| component.map(|value| -value))
}

/// Right-hand sides that share a pass at most: the f32 lanes of a vector register of 256 bits.
pub const MOST_LANES: usize = 8;
