//! Compressed rows of small values: scalars, or vectors for the coupling of pressure and displacement.

use std::ops::Range;

use rayon::prelude::*;

use super::element_connectivity::ElementConnectivity;
use super::lanes::Lanes;
use crate::rows::Rows;
use crate::vectorised::vectorised;

/// Rows handled by one thread at a time.
const ROW_CHUNK: usize = 1024;

/// A sparse matrix, columns ascending in each row. Values stand in an array of their own: beside its column a vector
/// would be padded, and a product reads them in one stream.
#[derive(Clone, Debug)]
pub struct SparseRows<T> {
    columns: Rows<u32>,
    /// In the order of the columns.
    values: Vec<T>,
}

/// The four rows and columns that each tetrahedron couples.
pub struct Couplings<'a> {
    pub rows: &'a [[u32; 4]],
    pub columns: &'a [[u32; 4]],
}

/// The values of neighbouring rows, and where those of each begin.
pub(super) struct ValueChunk<'a, T> {
    pub rows: Range<usize>,
    pub begins: Vec<usize>,
    pub values: &'a mut [T],
}

/// A value of a sparse matrix.
pub trait Entry: Copy + Send + Sync {
    fn add(&mut self, other: Self);
}

impl Entry for f64 {
    fn add(&mut self, other: f64) {
        *self += other;
    }
}

impl Entry for [f64; 3] {
    fn add(&mut self, other: [f64; 3]) {
        self.iter_mut().zip(other).for_each(|(sum, value)| *sum += value);
    }
}

impl<T: Entry> SparseRows<T> {
    /// The sum of 4 x 4 cell matrices; `value(cell, row, column)` with local numbers. Cells are added in
    /// their order, whatever the number of threads.
    pub fn assemble(
        row_count: usize,
        couplings: &Couplings,
        value: impl Fn(usize, usize, usize) -> T + Sync,
    ) -> Self {
        let mut connectivity = ElementConnectivity::default();
        couplings.rows.iter().for_each(|rows| connectivity.push(*rows));
        let around = connectivity.inverted(row_count);
        let chunks: Vec<Vec<Vec<(u32, T)>>> = (0..row_count.div_ceil(ROW_CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let rows = chunk * ROW_CHUNK..((chunk + 1) * ROW_CHUNK).min(row_count);
                rows.map(|row| {
                    let mut entries: Vec<(u32, T)> = Vec::with_capacity(24);
                    for &cell in around.row(row) {
                        let cell = cell as usize;
                        let mut named = couplings.rows[cell].iter();
                        let Some(local) = named.position(|&named| named as usize == row) else {
                            continue;
                        };
                        for (k, &column) in couplings.columns[cell].iter().enumerate() {
                            let part = value(cell, local, k);
                            match entries.iter_mut().find(|(known, _)| *known == column) {
                                Some((_, sum)) => sum.add(part),
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
        let mut matrix = SparseRows { columns: Rows::default(), values: Vec::new() };
        for entries in chunks.into_iter().flatten() {
            matrix.columns.push(entries.iter().map(|(column, _)| *column));
            matrix.values.extend(entries.iter().map(|(_, value)| value));
        }
        matrix
    }

    pub fn rows(&self) -> usize {
        self.columns.len()
    }

    /// The place of a column among those of its row.
    ///
    /// # Panics
    /// When the row does not have the column.
    pub(super) fn slot(&self, row: usize, column: u32) -> u16 {
        let found = self.columns.row(row).binary_search(&column);
        found.expect("the couplings are those that the matrix was made of") as u16
    }

    /// The values of chunks of rows, for threads to fill.
    pub(super) fn row_chunks(&mut self, rows: usize) -> Vec<ValueChunk<'_, T>> {
        let SparseRows { columns, values } = self;
        let mut rest = values.as_mut_slice();
        let mut chunks = Vec::new();
        for first in (0..columns.len()).step_by(rows) {
            let rows = first..(first + rows).min(columns.len());
            let begin = columns.range(first).start;
            let (own, others) = rest.split_at_mut(columns.range(rows.end - 1).end - begin);
            rest = others;
            let begins = rows.clone().map(|row| columns.range(row).start - begin).collect();
            chunks.push(ValueChunk { rows, begins, values: own });
        }
        chunks
    }

    /// The columns of a row and their values.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &T)> {
        let values = &self.values[self.columns.range(row)];
        self.columns.row(row).iter().map(|&c| c as usize).zip(values)
    }

    /// Memory in MB.
    pub fn megabytes(&self) -> f64 {
        (self.columns.bytes() + self.values.len() * size_of::<T>()) as f64 / 1e6
    }
}

// Sums are held apart from the product: the compiler does not use vector units for what it writes to memory term by term.

impl SparseRows<f64> {
    /// `product` = A x, for N right-hand sides.
    pub fn multiply<const N: usize>(&self, x: &[[f64; N]], product: &mut [[f64; N]]) {
        product.par_chunks_mut(ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            vectorised(
                #[inline(always)]
                || {
                    for (local, product) in product.iter_mut().enumerate() {
                        let mut sums = [0.0; N];
                        for (column, value) in self.row(chunk * ROW_CHUNK + local) {
                            for n in 0..N {
                                sums[n] += value * x[column][n];
                            }
                        }
                        *product = sums;
                    }
                },
            );
        });
    }
}

impl SparseRows<[f64; 3]> {
    /// `product` = A x for x of three unknowns a column. Columns beyond the end of x count as zero.
    pub fn contract<const N: usize>(&self, x: &[Lanes<f64, 3, N>], product: &mut [[f64; N]]) {
        product.par_chunks_mut(ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            vectorised(
                #[inline(always)]
                || {
                    for (local, product) in product.iter_mut().enumerate() {
                        let mut sums = [0.0; N];
                        for (column, v) in self.row(chunk * ROW_CHUNK + local) {
                            let Some(x) = x.get(column) else { break };
                            for n in 0..N {
                                sums[n] += v[0] * x[0][n] + v[1] * x[1][n] + v[2] * x[2][n];
                            }
                        }
                        *product = sums;
                    }
                },
            );
        });
    }

    /// `product` += A x for x of one unknown a column, three results a row. Only the first rows are wanted
    /// where `product` is shorter.
    pub fn add_expanded<const N: usize>(&self, x: &[[f64; N]], product: &mut [Lanes<f64, 3, N>]) {
        product.par_chunks_mut(ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            vectorised(
                #[inline(always)]
                || {
                    for (local, product) in product.iter_mut().enumerate() {
                        let mut sums = *product;
                        for (column, v) in self.row(chunk * ROW_CHUNK + local) {
                            let x = &x[column];
                            for c in 0..3 {
                                for n in 0..N {
                                    sums[c][n] += v[c] * x[n];
                                }
                            }
                        }
                        *product = sums;
                    }
                },
            );
        });
    }
}
