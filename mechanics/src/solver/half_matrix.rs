//! Symmetric sparse matrices of B x B blocks of which the diagonal and the strictly lower blocks are stored.
//!
//! One pass over the lower blocks is a whole symmetric product: each block is used for its own row and,
//! transposed, for the row of its column.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::element_connectivity::{ElementConnectivity, ElementsOfRow};
use super::lanes::{Lanes, Real, add_product, add_transposed};
use super::row_ordering::RowOrdering;
use crate::rows::Rows;
use crate::vectorised::vectorised;

/// Rows of a pattern that one thread makes at a time.
const ROW_CHUNK: usize = 2048;

/// The columns below the diagonal of each row, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    columns: Rows<u32>,
}

impl Pattern {
    /// Couples all members of each element.
    pub fn new(connectivity: &ElementConnectivity, around: &ElementsOfRow, rows: usize) -> Self {
        let chunks: Vec<Rows<u32>> = (0..rows.div_ceil(ROW_CHUNK))
            .into_par_iter()
            .map_init(
                || vec![u32::MAX; rows],
                |seen, chunk| {
                    let range = chunk * ROW_CHUNK..((chunk + 1) * ROW_CHUNK).min(rows);
                    lower_columns(connectivity, around, range, seen)
                },
            )
            .collect();
        Pattern { columns: Rows::joined(chunks) }
    }

    pub fn rows(&self) -> usize {
        self.columns.len()
    }

    /// Whether there is a block for a row and a column below it.
    pub fn couples(&self, row: usize, column: usize) -> bool {
        self.columns(row).binary_search(&(column as u32)).is_ok()
    }

    /// Where the blocks of a row lie.
    pub fn range(&self, row: usize) -> Range<usize> {
        self.columns.range(row)
    }

    pub fn columns(&self, row: usize) -> &[u32] {
        self.columns.row(row)
    }

    /// The number of blocks below the diagonal.
    pub fn len(&self) -> usize {
        self.columns.entries().len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The lower columns of each row in a range. `seen` is scratch that holds no row of the range.
fn lower_columns(
    connectivity: &ElementConnectivity,
    around: &ElementsOfRow,
    range: Range<usize>,
    seen: &mut [u32],
) -> Rows<u32> {
    let mut rows = Rows::with_room(range.len(), 8 * range.len());
    let mut columns = Vec::new();
    for row in range {
        columns.clear();
        for &element in around.row(row) {
            for &column in connectivity.row(element as usize) {
                if (column as usize) < row && seen[column as usize] != row as u32 {
                    seen[column as usize] = row as u32;
                    columns.push(column);
                }
            }
        }
        columns.sort_unstable();
        rows.push(columns.iter().copied());
    }
    rows
}

/// Diagonal and strictly lower blocks, row-major.
#[derive(Clone, Debug)]
pub struct HalfMatrix<T, const B: usize> {
    pub pattern: Arc<Pattern>,
    pub diagonal: Vec<[[T; B]; B]>,
    pub lower: Vec<[[T; B]; B]>,
}

/// Neighbouring rows of a half matrix.
pub struct RowChunk<'a, T, const B: usize> {
    pub first: usize,
    pub diagonal: &'a mut [[[T; B]; B]],
    pub lower: &'a mut [[[T; B]; B]],
}

impl<T: Real, const B: usize> HalfMatrix<T, B> {
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let zero = [[T::default(); B]; B];
        HalfMatrix {
            diagonal: vec![zero; pattern.rows()],
            lower: vec![zero; pattern.len()],
            pattern,
        }
    }

    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }

    /// The diagonal blocks and the lower blocks of chunks of rows, for threads to fill.
    pub fn row_chunks(&mut self, rows: usize) -> Vec<RowChunk<'_, T, B>> {
        let mut lower = self.lower.as_mut_slice();
        let mut chunks = Vec::new();
        for (chunk, diagonal) in self.diagonal.chunks_mut(rows).enumerate() {
            let first = chunk * rows;
            let end = self.pattern.range(first + diagonal.len() - 1).end;
            let count = end - self.pattern.range(first).start;
            let (own, rest) = lower.split_at_mut(count);
            lower = rest;
            chunks.push(RowChunk { first, diagonal, lower: own });
        }
        chunks
    }

    pub fn megabytes(&self) -> f64 {
        let blocks = (self.diagonal.len() + self.lower.len()) * B * B * size_of::<T>();
        blocks as f64 / 1e6 + self.pattern.columns.bytes() as f64 / 1e6
    }

    /// The columns below the diagonal of a row and their blocks.
    pub fn lower_row(&self, row: usize) -> impl Iterator<Item = (usize, &[[T; B]; B])> {
        let range = self.pattern.range(row);
        self.pattern.columns(row).iter().map(|&c| c as usize).zip(&self.lower[range])
    }

    /// A block below or on the diagonal.
    ///
    /// # Panics
    /// When the pattern does not couple the two rows, or the column lies beyond the row.
    pub fn block_mut(&mut self, row: usize, column: usize) -> &mut [[T; B]; B] {
        if row == column {
            return &mut self.diagonal[row];
        }
        let at = self.pattern.columns(row).binary_search(&(column as u32));
        let at = at.expect("cells only couple the rows that the pattern was made from");
        &mut self.lower[self.pattern.range(row).start + at]
    }

    /// `product` = A x over the free rows of an ordering.
    pub fn multiply<const N: usize>(
        &self,
        ordering: &RowOrdering,
        x: &[Lanes<T, B, N>],
        product: &mut [Lanes<T, B, N>],
    ) {
        let shares = ordering.split(product);
        shares.into_par_iter().zip(&ordering.parts).for_each(|(share, part)| {
            vectorised(
                #[inline(always)]
                || self.multiply_rows(part.clone(), x, share, part.start),
            );
        });
        vectorised(
            #[inline(always)]
            || self.multiply_rows(ordering.separator(), x, product, 0),
        );
    }

    /// `product` = A x over the rows of a range and, transposed, what they do to the rows of their columns;
    /// nothing else is written, and rows outside the range are added to.
    pub fn add_rows<const N: usize>(
        &self,
        rows: Range<usize>,
        x: &[Lanes<T, B, N>],
        product: &mut [Lanes<T, B, N>],
    ) {
        vectorised(
            #[inline(always)]
            || self.multiply_rows(rows.clone(), x, product, 0),
        );
    }

    /// The rows of a range, and their blocks transposed for the rows of their columns. `product` begins at
    /// row `first`; a row is overwritten before anything is added to it.
    #[inline(always)]
    pub(super) fn multiply_rows<const N: usize>(
        &self,
        rows: Range<usize>,
        x: &[Lanes<T, B, N>],
        product: &mut [Lanes<T, B, N>],
        first: usize,
    ) {
        for row in rows {
            let own = x[row];
            let mut sum = [[T::default(); N]; B];
            add_product(&mut sum, &self.diagonal[row], &own);
            let range = self.pattern.range(row);
            for (&column, block) in self.pattern.columns(row).iter().zip(&self.lower[range]) {
                add_product(&mut sum, block, &x[column as usize]);
                add_transposed(&mut product[column as usize - first], block, &own);
            }
            product[row - first] = sum;
        }
    }
}
