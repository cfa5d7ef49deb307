//! Sums over long vectors in a fixed order, so that any number of threads gives the same bits.
//!
//! Vectors hold the N values of an unknown side by side, one for each right-hand side.

use rayon::prelude::*;

/// Unknowns summed by one thread before partial sums are added in order.
const CHUNK: usize = 12_288;

/// Adds what each unknown gives, one by one within chunks, chunk by chunk.
fn sum<const N: usize, const M: usize>(
    unknowns: usize,
    of_unknown: impl Fn(usize, &mut [[f64; N]; M]) + Sync,
) -> [[f64; N]; M] {
    let partial: Vec<[[f64; N]; M]> = (0..unknowns.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sums = [[0.0; N]; M];
            for unknown in chunk * CHUNK..((chunk + 1) * CHUNK).min(unknowns) {
                of_unknown(unknown, &mut sums);
            }
            sums
        })
        .collect();
    let mut total = [[0.0; N]; M];
    for sums in partial {
        for (total, sums) in total.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
            *total += sums;
        }
    }
    total
}

/// The scalar product of each right-hand side.
pub fn dot<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> [f64; N] {
    let [sums] = sum(a.len(), |i, [sums]: &mut [[f64; N]; 1]| {
        for n in 0..N {
            sums[n] += a[i][n] * b[i][n];
        }
    });
    sums
}

/// The Euclidean norm of each right-hand side.
pub fn norm<const N: usize>(a: &[[f64; N]]) -> [f64; N] {
    dot(a, a).map(f64::sqrt)
}

/// a . z and b . z, with z in f32.
pub fn two_dots<const N: usize>(a: &[[f64; N]], b: &[[f64; N]], z: &[[f32; N]]) -> [[f64; N]; 2] {
    sum(a.len(), |i, [first, second]: &mut [[f64; N]; 2]| {
        for n in 0..N {
            let z = f64::from(z[i][n]);
            first[n] += a[i][n] * z;
            second[n] += b[i][n] * z;
        }
    })
}

/// x += step p and r -= step y.
pub fn advance<const N: usize>(
    x: &mut [[f64; N]],
    r: &mut [[f64; N]],
    step: &[f64; N],
    p: &[[f64; N]],
    y: &[[f64; N]],
) {
    let chunks = x.par_chunks_mut(CHUNK).zip(r.par_chunks_mut(CHUNK));
    chunks.zip(p.par_chunks(CHUNK).zip(y.par_chunks(CHUNK))).for_each(|((x, r), (p, y))| {
        for (((x, r), p), y) in x.iter_mut().zip(r).zip(p).zip(y) {
            for n in 0..N {
                x[n] += step[n] * p[n];
                r[n] -= step[n] * y[n];
            }
        }
    });
}

/// p = scale z + factor p.
pub fn turn<const N: usize>(
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
pub fn interleave<const N: usize, const B: usize>(columns: &[Vec<[f64; B]>]) -> Vec<[[f64; N]; B]> {
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
