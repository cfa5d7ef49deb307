//! Sums over long vectors in a fixed order, so that any number of threads gives the same bits.

use rayon::prelude::*;

/// Values summed by one thread before partial sums are added in order.
const CHUNK: usize = 8192;

/// The scalar product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let partial: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(|(a, b)| a.iter().zip(b).map(|(x, y)| x * y).sum())
        .collect();
    partial.iter().sum()
}

/// The Euclidean norm.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// y += factor x.
pub fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK)).for_each(|(y, x)| {
        for (y, x) in y.iter_mut().zip(x) {
            *y += factor * x;
        }
    });
}

/// p = z + factor p.
pub fn scale_and_add(p: &mut [f64], factor: f64, z: &[f64]) {
    p.par_chunks_mut(CHUNK).zip(z.par_chunks(CHUNK)).for_each(|(p, z)| {
        for (p, z) in p.iter_mut().zip(z) {
            *p = z + factor * *p;
        }
    });
}
