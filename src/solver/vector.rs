//! Sums over long vectors in a fixed order, so that any number of threads gives the same bits.

use rayon::prelude::*;

use super::lanes::Lanes;

/// Rows summed by one thread before partial sums are added in order.
const CHUNK: usize = 4096;

/// Vectors of N right-hand sides.
type Vector<const N: usize> = [Lanes<f64, 3, N>];

/// Adds what each row gives, row by row within chunks, chunk by chunk.
fn sum<const N: usize, const M: usize>(
    rows: usize,
    of_row: impl Fn(usize, &mut [[f64; N]; M]) + Sync,
) -> [[f64; N]; M] {
    let partial: Vec<[[f64; N]; M]> = (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sums = [[0.0; N]; M];
            for row in chunk * CHUNK..((chunk + 1) * CHUNK).min(rows) {
                of_row(row, &mut sums);
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
pub fn dot<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> [f64; N] {
    let [sums] = sum(a.len(), |row, [sums]: &mut [[f64; N]; 1]| {
        for (a, b) in a[row].iter().zip(&b[row]) {
            for n in 0..N {
                sums[n] += a[n] * b[n];
            }
        }
    });
    sums
}

/// The Euclidean norm of each right-hand side.
pub fn norm<const N: usize>(a: &Vector<N>) -> [f64; N] {
    dot(a, a).map(f64::sqrt)
}

/// a . z and b . z, with z in f32.
pub fn two_dots<const N: usize>(
    a: &Vector<N>,
    b: &Vector<N>,
    z: &[Lanes<f32, 3, N>],
) -> [[f64; N]; 2] {
    sum(a.len(), |row, [first, second]: &mut [[f64; N]; 2]| {
        for c in 0..3 {
            for n in 0..N {
                let z = f64::from(z[row][c][n]);
                first[n] += a[row][c][n] * z;
                second[n] += b[row][c][n] * z;
            }
        }
    })
}

/// x += step p and r -= step y.
pub fn advance<const N: usize>(
    x: &mut Vector<N>,
    r: &mut Vector<N>,
    step: &[f64; N],
    p: &Vector<N>,
    y: &Vector<N>,
) {
    let chunks = x.par_chunks_mut(CHUNK).zip(r.par_chunks_mut(CHUNK));
    chunks.zip(p.par_chunks(CHUNK).zip(y.par_chunks(CHUNK))).for_each(|((x, r), (p, y))| {
        for (((x, r), p), y) in x.iter_mut().zip(r).zip(p).zip(y) {
            for c in 0..3 {
                for n in 0..N {
                    x[c][n] += step[n] * p[c][n];
                    r[c][n] -= step[n] * y[c][n];
                }
            }
        }
    });
}

/// p = scale z + factor p.
pub fn turn<const N: usize>(
    p: &mut Vector<N>,
    factor: &[f64; N],
    z: &[Lanes<f32, 3, N>],
    scale: &[f64; N],
) {
    p.par_chunks_mut(CHUNK).zip(z.par_chunks(CHUNK)).for_each(|(p, z)| {
        for (p, z) in p.iter_mut().zip(z) {
            for c in 0..3 {
                for n in 0..N {
                    p[c][n] = scale[n] * f64::from(z[c][n]) + factor[n] * p[c][n];
                }
            }
        }
    });
}

/// Unknowns of several right-hand sides side by side; those that are missing are zero.
pub fn interleave<const N: usize>(columns: &[super::Unknowns]) -> Vec<Lanes<f64, 3, N>> {
    let mut lanes = vec![[[0.0; N]; 3]; columns.first().map_or(0, Vec::len)];
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
pub fn column<const N: usize>(lanes: &Vector<N>, n: usize) -> super::Unknowns {
    lanes.iter().map(|values| values.map(|component| component[n])).collect()
}
