//! Gauss-Seidel sweeps on half a matrix in f32: a preconditioner needs no more digits, and reads half
//! the memory.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::inverse::inverse_block;
use crate::solver::half_matrix::{HalfMatrix, Pattern};
use crate::solver::lanes::{Lanes, add_product, add_transposed, negated};
use crate::solver::row_ordering::RowOrdering;
use crate::vectorised::vectorised;

/// Rows that one thread prepares at a time.
const CHUNK: usize = 4096;

/// The free rows of a matrix, ready to be swept.
pub(super) struct Smoother<const B: usize> {
    pattern: Arc<Pattern>,
    pub ordering: Arc<RowOrdering>,
    lower: Vec<[[f32; B]; B]>,
    inverse_diagonal: Vec<[[f32; B]; B]>,
}

/// Values of all rows for N right-hand sides.
pub(super) type Vector<const B: usize, const N: usize> = [Lanes<f32, B, N>];

impl<const B: usize> Smoother<B> {
    /// `mask` clears what is held from a block, given its row and column.
    pub fn new(
        matrix: &HalfMatrix<f64, B>,
        ordering: Arc<RowOrdering>,
        mask: impl Fn(usize, usize, &mut [[f64; B]; B]) + Sync,
    ) -> Self {
        let pattern = matrix.pattern.clone();
        let masked = |row: usize, column: usize, block: &[[f64; B]; B]| {
            let mut block = *block;
            mask(row, column, &mut block);
            block
        };
        let end = if ordering.free == 0 { 0 } else { pattern.range(ordering.free - 1).end };
        let mut lower = vec![[[0.0; B]; B]; end];
        let mut rest = lower.as_mut_slice();
        let mut chunks = Vec::new();
        for first in (0..ordering.free).step_by(CHUNK) {
            let rows = first..(first + CHUNK).min(ordering.free);
            let count = pattern.range(rows.end - 1).end - pattern.range(first).start;
            let (own, others) = rest.split_at_mut(count);
            rest = others;
            chunks.push((rows, own));
        }
        let inverse_diagonal = chunks
            .into_par_iter()
            .flat_map_iter(|(rows, blocks)| {
                let lower = rows.clone().flat_map(|row| {
                    matrix.lower_row(row).map(move |(column, block)| (row, column, block))
                });
                for (target, (row, column, block)) in blocks.iter_mut().zip(lower) {
                    *target = masked(row, column, block).map(|v| v.map(|value| value as f32));
                }
                rows.map(|row| inverse_block(&masked(row, row, &matrix.diagonal[row])))
            })
            .collect();
        Smoother { pattern, ordering, lower, inverse_diagonal }
    }

    pub fn rows(&self) -> usize {
        self.inverse_diagonal.len()
    }

    pub fn megabytes(&self) -> f64 {
        ((self.lower.len() + self.inverse_diagonal.len()) * B * B * 4) as f64 / 1e6
    }

    /// Solves (D + L) x = right; the residual it leaves, `rest` = -L^T x, is gathered in the same pass.
    pub fn forward<const N: usize>(
        &self,
        right: &Vector<B, N>,
        x: &mut Vector<B, N>,
        rest: &mut Vector<B, N>,
    ) {
        let shares = self.ordering.split(x).into_par_iter().zip(self.ordering.split(rest));
        shares.zip(&self.ordering.parts).for_each(|((x, rest), part)| {
            vectorised(
                #[inline(always)]
                || self.forward_rows(part.clone(), right, Share { first: part.start, x, rest }),
            );
        });
        vectorised(
            #[inline(always)]
            || self.forward_rows(self.ordering.separator(), right, Share { first: 0, x, rest }),
        );
    }

    /// One sweep from the last row to the first. `remaining` is the right-hand side, from which rows take
    /// what they do to the rows before them.
    pub fn backward<const N: usize>(&self, x: &mut Vector<B, N>, remaining: &mut Vector<B, N>) {
        vectorised(
            #[inline(always)]
            || {
                self.backward_rows(
                    self.ordering.separator(),
                    Share { first: 0, x, rest: remaining },
                )
            },
        );
        let shares = self.ordering.split(x).into_par_iter().zip(self.ordering.split(remaining));
        shares.zip(&self.ordering.parts).for_each(|((x, remaining), part)| {
            vectorised(
                #[inline(always)]
                || {
                    self.backward_rows(
                        part.clone(),
                        Share { first: part.start, x, rest: remaining },
                    )
                },
            );
        });
    }

    #[inline(always)]
    fn forward_rows<const N: usize>(
        &self,
        rows: Range<usize>,
        right: &Vector<B, N>,
        share: Share<B, N>,
    ) {
        let Share { first, x, rest } = share;
        for row in rows {
            let columns = self.pattern.columns(row);
            let blocks = &self.lower[self.pattern.range(row)];
            let mut sum = negated(&right[row]);
            for (&column, block) in columns.iter().zip(blocks) {
                add_product(&mut sum, block, &x[column as usize - first]);
            }
            let mut taken = [[0.0; N]; B];
            add_product(&mut taken, &self.inverse_diagonal[row], &sum);
            x[row - first] = negated(&taken);
            rest[row - first] = [[0.0; N]; B];
            for (&column, block) in columns.iter().zip(blocks) {
                add_transposed(&mut rest[column as usize - first], block, &taken);
            }
        }
    }

    #[inline(always)]
    fn backward_rows<const N: usize>(&self, rows: Range<usize>, share: Share<B, N>) {
        let Share { first, x, rest: remaining } = share;
        for row in rows.rev() {
            let columns = self.pattern.columns(row);
            let blocks = &self.lower[self.pattern.range(row)];
            let mut sum = negated(&remaining[row - first]);
            for (&column, block) in columns.iter().zip(blocks) {
                add_product(&mut sum, block, &x[column as usize - first]);
            }
            let mut taken = [[0.0; N]; B];
            add_product(&mut taken, &self.inverse_diagonal[row], &sum);
            x[row - first] = negated(&taken);
            for (&column, block) in columns.iter().zip(blocks) {
                add_transposed(&mut remaining[column as usize - first], block, &taken);
            }
        }
    }
}

/// The rows that one thread sweeps: those of a part, or all of them for the separator.
struct Share<'a, const B: usize, const N: usize> {
    /// The row with which the vectors begin.
    first: usize,
    x: &'a mut Vector<B, N>,
    rest: &'a mut Vector<B, N>,
}
