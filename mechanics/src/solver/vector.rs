//! Sums over long vectors in a fixed order, so that any number of threads gives the same bits.
//!
//! Vectors hold the N values of an unknown side by side, one for each right-hand side.

use rayon::prelude::*;

use super::lanes::MOST_LANES;
use crate::vectorised::vectorised;

/// Unknowns summed by one thread before partial sums are added in order.
const CHUNK: usize = 12_288;

/// Sums that run side by side within a chunk, so that none waits for the one before. The number of
/// right-hand sides divides it.
const ABREAST: usize = MOST_LANES;

/// Adds partial sums in the order of the chunks.
fn total<const N: usize>(partial: impl IntoIterator<Item = [f64; ABREAST]>) -> [f64; N] {
    let mut total = [0.0; N];
    for sums in partial {
        for (place, sum) in sums.iter().enumerate() {
            total[place % N] += sum;
        }
    }
    total
}

/// The scalar product within a chunk.
#[inline(always)]
fn add_products<T: Copy + Into<f64>>(a: &[f64], b: &[T], sums: &mut [f64; ABREAST]) {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<ABREAST>(), b.as_chunks::<ABREAST>());
    for (a, b) in a.iter().zip(b) {
        for k in 0..ABREAST {
            sums[k] += a[k] * b[k].into();
        }
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum += a * (*b).into();
    }
}

/// The scalar product of each right-hand side; the second vector may be f32.
pub fn dot<const N: usize, T>(a: &[[f64; N]], b: &[[T; N]]) -> [f64; N]
where
    T: Copy + Into<f64> + Sync,
{
    let chunks = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK));
    let partial: Vec<[f64; ABREAST]> = chunks
        .map(|(a, b)| {
            let mut sums = [0.0; ABREAST];
            vectorised(
                #[inline(always)]
                || add_products(a.as_flattened(), b.as_flattened(), &mut sums),
            );
            sums
        })
        .collect();
    total(partial)
}

/// The Euclidean norm of each right-hand side.
pub fn norm<const N: usize>(a: &[[f64; N]]) -> [f64; N] {
    dot(a, a).map(f64::sqrt)
}

/// x += step p and r -= step y; returns the norm of r.
pub fn update<const N: usize>(
    x: &mut [[f64; N]],
    r: &mut [[f64; N]],
    step: &[f64; N],
    p: &[[f64; N]],
    y: &[[f64; N]],
) -> [f64; N] {
    let chunks = x.par_chunks_mut(CHUNK).zip(r.par_chunks_mut(CHUNK));
    let chunks = chunks.zip(p.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)));
    let partial: Vec<[f64; ABREAST]> = chunks
        .map(|((x, r), (p, y))| {
            let mut sums = [0.0; ABREAST];
            vectorised(
                #[inline(always)]
                || {
                    for (((x, r), p), y) in x.iter_mut().zip(&mut *r).zip(p).zip(y) {
                        for n in 0..N {
                            x[n] += step[n] * p[n];
                            r[n] -= step[n] * y[n];
                        }
                    }
                    add_products(r.as_flattened(), r.as_flattened(), &mut sums);
                },
            );
            sums
        })
        .collect();
    total(partial).map(f64::sqrt)
}

/// p = scale z + factor p.
pub fn axpby<const N: usize>(
    p: &mut [[f64; N]],
    factor: &[f64; N],
    z: &[[f32; N]],
    scale: &[f64; N],
) {
    p.par_chunks_mut(CHUNK).zip(z.par_chunks(CHUNK)).for_each(|(p, z)| {
        for (p, z) in p.iter_mut().zip(z) {
            for n in 0..N {
                p[n] = scale[n] * f64::from(z[n]) + factor[n] * p[n];
            }
        }
    });
}

/// y -= the sum of factors times vectors.
pub fn subtract_all<const N: usize>(y: &mut [[f64; N]], terms: &[([f64; N], &[[f64; N]])]) {
    y.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, y)| {
        let first = chunk * CHUNK;
        for (factor, vector) in terms {
            for (y, value) in y.iter_mut().zip(&vector[first..]) {
                for n in 0..N {
                    y[n] -= factor[n] * value[n];
                }
            }
        }
    });
}

/// y *= factor.
pub fn scale<const N: usize>(y: &mut [[f64; N]], factor: &[f64; N]) {
    y.par_chunks_mut(CHUNK).for_each(|y| {
        for y in y {
            for n in 0..N {
                y[n] *= factor[n];
            }
        }
    });
}

/// Unknowns of several right-hand sides side by side; those that are missing are zero.
pub fn pack_lanes<const N: usize, const B: usize>(columns: &[Vec<[f64; B]>]) -> Vec<[[f64; N]; B]> {
    let mut lanes = vec![[[0.0; N]; B]; columns.first().map_or(0, Vec::len)];
    for (n, column) in columns.iter().enumerate() {
        for (lanes, values) in lanes.iter_mut().zip(column) {
            for (lane, value) in lanes.iter_mut().zip(values) {
                lane[n] = *value;
            }
        }
    }
    lanes
}

/// One right-hand side out of several.
pub fn column<const N: usize, const B: usize>(lanes: &[[[f64; N]; B]], n: usize) -> Vec<[f64; B]> {
    lanes.iter().map(|values| values.map(|component| component[n])).collect()
}

/// Zero where the divisor is: a right-hand side that has converged does not move.
pub fn ratio(value: f64, divisor: f64) -> f64 {
    if divisor == 0.0 { 0.0 } else { value / divisor }
}

/// NaN counts as the largest.
pub fn largest<const N: usize>(values: &[f64; N]) -> f64 {
    values.iter().fold(0.0, |largest, &v| if v > largest || v.is_nan() { v } else { largest })
}
