//! Inverses of positive semidefinite matrices on the directions in which they are definite.
//!
//! Aggregates of one row, or of rows on a line, have rotations that do nothing; held unknowns have rows
//! of zeros. They get nothing.

use crate::solver::lanes::Lanes;

/// Pivots below this share of the scaled diagonal of ones are left out.
const SINGULAR: f64 = 1e-6;

/// The inverse of a diagonal block.
pub(super) fn inverse_block<const B: usize>(block: &[[f64; B]; B]) -> [[f32; B]; B] {
    let mut values = *block;
    let mut scratch = ([0.0; B], [false; B], [0.0; B]);
    let (scale, done, pivot_row) = (&mut scratch.0, &mut scratch.1, &mut scratch.2);
    invert(values.as_flattened_mut(), B, Scratch { scale, done, pivot_row });
    values.map(|values| values.map(|value| value as f32))
}

/// As long as the matrix is wide.
struct Scratch<'a> {
    scale: &'a mut [f64],
    done: &'a mut [bool],
    pivot_row: &'a mut [f64],
}

/// Replaces a row-major matrix by its inverse. Gauss-Jordan elimination on the diagonal, largest pivot
/// first, after scaling: rotations and translations differ in unit.
fn invert(a: &mut [f64], size: usize, scratch: Scratch) {
    let Scratch { scale, done, pivot_row } = scratch;
    for (i, scale) in scale.iter_mut().enumerate() {
        let value = a[i * size + i];
        *scale = if value > 0.0 { value.sqrt().recip() } else { 0.0 };
    }
    for i in 0..size {
        for j in 0..size {
            a[i * size + j] *= scale[i] * scale[j];
        }
    }
    done.fill(false);
    for _ in 0..size {
        let open = (0..size).filter(|&i| !done[i]);
        let largest = open.max_by(|&i, &j| a[i * size + i].total_cmp(&a[j * size + j]));
        let Some(pivot) = largest.filter(|&pivot| a[pivot * size + pivot] >= SINGULAR) else {
            break;
        };
        done[pivot] = true;
        sweep(a, size, pivot, pivot_row);
    }
    for i in 0..size {
        for j in 0..size {
            let is_kept = done[i] && done[j];
            a[i * size + j] *= if is_kept { -scale[i] * scale[j] } else { 0.0 };
        }
    }
}

/// The sweep operator: after sweeping all pivots a symmetric matrix is minus its inverse.
fn sweep(a: &mut [f64], size: usize, pivot: usize, pivot_row: &mut [f64]) {
    let value = a[pivot * size + pivot];
    pivot_row.copy_from_slice(&a[pivot * size..(pivot + 1) * size]);
    for i in (0..size).filter(|&i| i != pivot) {
        let row = &mut a[i * size..(i + 1) * size];
        let factor = row[pivot] / value;
        for (entry, above) in row.iter_mut().zip(&*pivot_row) {
            *entry -= factor * above;
        }
        row[pivot] = factor;
    }
    for entry in &mut a[pivot * size..(pivot + 1) * size] {
        *entry /= value;
    }
    a[pivot * size + pivot] = -1.0 / value;
}

/// The exact solve on the coarsest level.
pub(super) struct DenseInverse {
    /// Row-major.
    values: Vec<f32>,
    size: usize,
}

impl DenseInverse {
    /// Of a row-major matrix.
    pub fn of(mut dense: Vec<f64>, size: usize) -> Self {
        let (mut scale, mut done, mut pivot_row) =
            (vec![0.0; size], vec![false; size], vec![0.0; size]);
        let scratch = Scratch { scale: &mut scale, done: &mut done, pivot_row: &mut pivot_row };
        invert(&mut dense, size, scratch);
        DenseInverse { values: dense.iter().map(|value| *value as f32).collect(), size }
    }

    pub fn apply<const N: usize>(&self, right: &[Lanes<f32, 6, N>], x: &mut [Lanes<f32, 6, N>]) {
        let right = right.as_flattened();
        for (row, result) in x.as_flattened_mut().iter_mut().enumerate() {
            *result = [0.0; N];
            let values = &self.values[row * self.size..(row + 1) * self.size];
            for (value, right) in values.iter().zip(right) {
                for n in 0..N {
                    result[n] += value * right[n];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_a_definite_matrix_times_the_matrix_is_one() {
        let matrix = [[4.0, 1.0, 0.5], [1.0, 3.0, -1.0], [0.5, -1.0, 2000.0]];
        let inverse = inverse_block(&matrix);
        let left = nalgebra::Matrix3::from_fn(|i, j| f64::from(inverse[i][j]));
        let right = nalgebra::Matrix3::from_fn(|i, j| matrix[i][j]);
        assert!((left * right - nalgebra::Matrix3::identity()).amax() < 1e-4, "{inverse:?}");
    }

    #[test]
    fn directions_without_stiffness_get_nothing() {
        let inverse = inverse_block(&[[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]]);
        let entries: Vec<f32> = inverse.as_flattened().to_vec();
        assert_eq!(entries.iter().filter(|entry| **entry != 0.0).count(), 1, "{entries:?}");
        assert!(entries.contains(&0.5));
    }
}
