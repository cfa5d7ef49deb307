//! Compressed rows of small values: scalars, or vectors for the coupling of pressure and displacement.

use std::ops::AddAssign;

use nalgebra::Vector3;
use rayon::prelude::*;

/// Rows handled by one thread at a time.
const ROW_CHUNK: usize = 1024;

/// A sparse matrix, columns ascending in each row.
#[derive(Clone, Debug)]
pub struct SparseRows<T> {
    start: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<T>,
}

/// The four rows and columns that each tetrahedron couples.
pub struct Couplings<'a> {
    pub rows: &'a [[u32; 4]],
    pub columns: &'a [[u32; 4]],
}

impl<T: Copy + AddAssign + Send + Sync> SparseRows<T> {
    /// The sum of 4 x 4 cell matrices; `value(cell, row, column)` with local numbers. Cells are added in
    /// their order, whatever the number of threads.
    pub fn assemble(
        row_count: usize,
        couplings: &Couplings,
        value: impl Fn(usize, usize, usize) -> T + Sync,
    ) -> Self {
        let (first, cells) = cells_around(row_count, couplings.rows);
        let chunks: Vec<Vec<Vec<(u32, T)>>> = (0..row_count.div_ceil(ROW_CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let rows = chunk * ROW_CHUNK..((chunk + 1) * ROW_CHUNK).min(row_count);
                rows.map(|row| {
                    let mut entries: Vec<(u32, T)> = Vec::with_capacity(24);
                    for &place in &cells[first[row]..first[row + 1]] {
                        let (cell, local) = (place as usize / 4, place as usize % 4);
                        for (k, &column) in couplings.columns[cell].iter().enumerate() {
                            let part = value(cell, local, k);
                            match entries.iter_mut().find(|(known, _)| *known == column) {
                                Some((_, sum)) => *sum += part,
                                None => entries.push((column, part)),
                            }
                        }
                    }
                    entries.sort_unstable_by_key(|(column, _)| *column);
                    entries
                })
                .collect()
            })
            .collect();
        let mut matrix = SparseRows { start: vec![0], columns: Vec::new(), values: Vec::new() };
        for entries in chunks.into_iter().flatten() {
            matrix.columns.extend(entries.iter().map(|(column, _)| column));
            matrix.values.extend(entries.iter().map(|(_, value)| value));
            matrix.start.push(matrix.columns.len());
        }
        matrix
    }

    pub fn rows(&self) -> usize {
        self.start.len() - 1
    }

    /// The columns of a row and their values.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &T)> {
        let range = self.start[row]..self.start[row + 1];
        self.columns[range.clone()].iter().map(|&c| c as usize).zip(&self.values[range])
    }

    /// Memory in MB.
    pub fn megabytes(&self) -> f64 {
        (self.columns.len() * (4 + size_of::<T>()) + self.start.len() * 8) as f64 / 1e6
    }
}

/// For each row the places `4 cell + local` at which cells name it: those of row r stand between the
/// r-th and the next entry of the first list.
fn cells_around(row_count: usize, rows: &[[u32; 4]]) -> (Vec<usize>, Vec<u32>) {
    let mut first = vec![0_usize; row_count + 1];
    for &row in rows.as_flattened() {
        first[row as usize + 1] += 1;
    }
    for row in 0..row_count {
        first[row + 1] += first[row];
    }
    let mut next = first.clone();
    let mut places = vec![0; first[row_count]];
    for (place, &row) in rows.as_flattened().iter().enumerate() {
        places[next[row as usize]] = place as u32;
        next[row as usize] += 1;
    }
    (first, places)
}

impl SparseRows<f64> {
    /// `product` = A x.
    pub fn multiply(&self, x: &[f64], product: &mut [f64]) {
        product.par_chunks_mut(ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            for (local, sum) in product.iter_mut().enumerate() {
                let row = self.row(chunk * ROW_CHUNK + local);
                *sum = row.map(|(column, value)| value * x[column]).sum();
            }
        });
    }
}

impl SparseRows<Vector3<f64>> {
    /// `product` = A x for x of three unknowns a column.
    pub fn contract(&self, x: &[f64], product: &mut [f64]) {
        product.par_chunks_mut(ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            for (local, sum) in product.iter_mut().enumerate() {
                *sum = 0.0;
                for (column, v) in self.row(chunk * ROW_CHUNK + local) {
                    let x = &x[3 * column..3 * column + 3];
                    *sum += v.x * x[0] + v.y * x[1] + v.z * x[2];
                }
            }
        });
    }

    /// `product` += A x for x of one unknown a column, three results a row.
    pub fn add_expanded(&self, x: &[f64], product: &mut [f64]) {
        product.par_chunks_mut(3 * ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            for (local, sums) in product.chunks_exact_mut(3).enumerate() {
                let row = self.row(chunk * ROW_CHUNK + local);
                let sum = row
                    .fold(Vector3::zeros(), |sum: Vector3<f64>, (column, v)| sum + v * x[column]);
                for (total, part) in sums.iter_mut().zip(&sum) {
                    *total += part;
                }
            }
        });
    }
}
