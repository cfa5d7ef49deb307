//! Diagonal and strictly lower blocks of a symmetric matrix, and the Gauss-Seidel sweeps they allow.

use nalgebra::SMatrix;

use super::rows::{BlockRows, Dense};

/// B x B blocks in f32.
pub(super) struct HalfMatrix<const B: usize> {
    row_start: Vec<usize>,
    columns: Vec<u32>,
    lower: Vec<[[f32; B]; B]>,
    inverse_diagonal: Vec<[[f32; B]; B]>,
}

impl<const B: usize> HalfMatrix<B> {
    pub fn of(full: &impl BlockRows<B>) -> Self {
        let mut half = HalfMatrix {
            row_start: vec![0],
            columns: Vec::new(),
            lower: Vec::new(),
            inverse_diagonal: Vec::with_capacity(full.rows()),
        };
        for row in 0..full.rows() {
            for (column, block) in full.row(row) {
                if column < row {
                    half.columns.push(column as u32);
                    half.lower.push(std::array::from_fn(|i| block[i].map(|value| value as f32)));
                } else if column == row {
                    half.inverse_diagonal.push(inverse(&block));
                }
            }
            half.row_start.push(half.columns.len());
        }
        half
    }

    /// One forward sweep from zero, the correction of what it leaves, and one backward sweep.
    pub fn cycle(&self, right: &[f32], correct: impl FnOnce(&[f32]) -> Vec<f32>) -> Vec<f32> {
        let (mut x, rest) = self.forward_from_zero(right);
        for (x, correction) in x.chunks_exact_mut(1).zip(correct(&rest)) {
            x[0] += correction;
        }
        self.backward(right, &mut x);
        x
    }

    /// Solves (D + L) x = right; the residual it leaves is -L^T x, gathered in the same pass.
    fn forward_from_zero(&self, right: &[f32]) -> (Vec<f32>, Vec<f32>) {
        let mut x = vec![0.0; right.len()];
        let mut rest = vec![0.0; right.len()];
        for row in 0..self.inverse_diagonal.len() {
            let range = self.row_start[row]..self.row_start[row + 1];
            let mut sum: [f32; B] = block_of(right, row);
            for (&column, block) in
                self.columns[range.clone()].iter().zip(&self.lower[range.clone()])
            {
                subtract_product(&mut sum, block, &block_of(&x, column as usize));
            }
            let solved = product(&self.inverse_diagonal[row], &sum);
            x[B * row..B * row + B].copy_from_slice(&solved);
            for (&column, block) in self.columns[range.clone()].iter().zip(&self.lower[range]) {
                let first = B * column as usize;
                subtract_transposed(&mut rest[first..first + B], block, &solved);
            }
        }
        (x, rest)
    }

    /// One Gauss-Seidel sweep from the last row to the first.
    fn backward(&self, right: &[f32], x: &mut [f32]) {
        // What the rows below, already swept, take from each row.
        let mut remaining = right.to_vec();
        for row in (0..self.inverse_diagonal.len()).rev() {
            let range = self.row_start[row]..self.row_start[row + 1];
            let mut sum: [f32; B] = block_of(&remaining, row);
            for (&column, block) in
                self.columns[range.clone()].iter().zip(&self.lower[range.clone()])
            {
                subtract_product(&mut sum, block, &block_of(x, column as usize));
            }
            let solved = product(&self.inverse_diagonal[row], &sum);
            x[B * row..B * row + B].copy_from_slice(&solved);
            for (&column, block) in self.columns[range.clone()].iter().zip(&self.lower[range]) {
                let first = B * column as usize;
                subtract_transposed(&mut remaining[first..first + B], block, &solved);
            }
        }
    }
}

fn block_of<const B: usize>(vector: &[f32], row: usize) -> [f32; B] {
    std::array::from_fn(|i| vector[B * row + i])
}

fn product<const B: usize>(block: &[[f32; B]; B], x: &[f32; B]) -> [f32; B] {
    std::array::from_fn(|i| block[i].iter().zip(x).map(|(a, b)| a * b).sum())
}

fn subtract_product<const B: usize>(sum: &mut [f32; B], block: &[[f32; B]; B], x: &[f32; B]) {
    for (sum, row) in sum.iter_mut().zip(block) {
        for (a, b) in row.iter().zip(x) {
            *sum -= a * b;
        }
    }
}

fn subtract_transposed<const B: usize>(sum: &mut [f32], block: &[[f32; B]; B], x: &[f32; B]) {
    for (row, x) in block.iter().zip(x) {
        for (sum, a) in sum.iter_mut().zip(row) {
            *sum -= a * x;
        }
    }
}

/// The inverse of a positive semidefinite block on the directions in which it is definite: aggregates
/// of one row, or of rows on a line, have rotations that do nothing.
fn inverse<const B: usize>(block: &Dense<B>) -> [[f32; B]; B] {
    let scale: [f64; B] =
        std::array::from_fn(|i| if block[i][i] > 0.0 { block[i][i].sqrt().recip() } else { 0.0 });
    let scaled = SMatrix::<f64, B, B>::from_fn(|i, j| block[i][j] * scale[i] * scale[j]);
    let inverse = pseudo_inverse(&scaled);
    std::array::from_fn(|i| std::array::from_fn(|j| (inverse[(i, j)] * scale[i] * scale[j]) as f32))
}

/// Gauss-Jordan elimination on the diagonal, largest pivot first, leaving out pivots below 1e-6.
fn pseudo_inverse<const B: usize>(matrix: &SMatrix<f64, B, B>) -> SMatrix<f64, B, B> {
    let mut a = *matrix;
    let mut done = [false; B];
    for _ in 0..B {
        let open = (0..B).filter(|&i| !done[i]);
        let Some(pivot) = open.max_by(|&i, &j| a[(i, i)].total_cmp(&a[(j, j)])) else { break };
        let value = a[(pivot, pivot)];
        if value < 1e-6 {
            break;
        }
        done[pivot] = true;
        // The sweep operator: after sweeping all pivots the matrix is minus its inverse.
        for i in (0..B).filter(|&i| i != pivot) {
            for j in (0..B).filter(|&j| j != pivot) {
                a[(i, j)] -= a[(i, pivot)] * a[(pivot, j)] / value;
            }
        }
        for i in (0..B).filter(|&i| i != pivot) {
            a[(i, pivot)] /= value;
            a[(pivot, i)] /= value;
        }
        a[(pivot, pivot)] = -1.0 / value;
    }
    SMatrix::from_fn(|i, j| if done[i] && done[j] { -a[(i, j)] } else { 0.0 })
}
