//! Gauss-Seidel sweeps on half a matrix in f32: a preconditioner needs no more digits, and reads half
//! the memory.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::inverse::inverse_block;
use crate::solver::half_matrix::{HalfMatrix, Pattern};
use crate::solver::lanes::{Lanes, add_product, subtract_product, subtract_transposed};
use crate::solver::layout::Layout;
use crate::solver::vectorised::vectorised;

/// The free rows of a matrix, ready to be swept.
pub(super) struct Smoother<const B: usize> {
    pattern: Arc<Pattern>,
    pub layout: Arc<Layout>,
    lower: Vec<[[f32; B]; B]>,
    inverse_diagonal: Vec<[[f32; B]; B]>,
}

/// Values of all rows for N right-hand sides.
pub(super) type Vector<const B: usize, const N: usize> = [Lanes<f32, B, N>];

impl<const B: usize> Smoother<B> {
    /// `mask` clears what is held from a block, given its row and column.
    pub fn new(
        matrix: &HalfMatrix<f64, B>,
        layout: Arc<Layout>,
        mask: impl Fn(usize, usize, &mut [[f64; B]; B]),
    ) -> Self {
        let mut lower = Vec::with_capacity(matrix.pattern.range(layout.free.max(1) - 1).end);
        let mut inverse_diagonal = Vec::with_capacity(layout.free);
        for row in 0..layout.free {
            for (column, block) in matrix.lower_row(row) {
                let mut block = *block;
                mask(row, column, &mut block);
                lower.push(block.map(|values| values.map(|value| value as f32)));
            }
            let mut diagonal = matrix.diagonal[row];
            mask(row, row, &mut diagonal);
            inverse_diagonal.push(inverse_block(&diagonal));
        }
        Smoother { pattern: matrix.pattern.clone(), layout, lower, inverse_diagonal }
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
        let shares = self.layout.split(x).into_par_iter().zip(self.layout.split(rest));
        shares.zip(&self.layout.parts).for_each(|((x, rest), part)| {
            vectorised(
                #[inline(always)]
                || self.forward_rows(part.clone(), right, x, rest, part.start),
            );
        });
        vectorised(
            #[inline(always)]
            || self.forward_rows(self.layout.separator(), right, x, rest, 0),
        );
    }

    /// One sweep from the last row to the first. `remaining` is the right-hand side, from which rows take
    /// what they do to the rows before them.
    pub fn backward<const N: usize>(&self, x: &mut Vector<B, N>, remaining: &mut Vector<B, N>) {
        vectorised(
            #[inline(always)]
            || self.backward_rows(self.layout.separator(), x, remaining, 0),
        );
        let shares = self.layout.split(x).into_par_iter().zip(self.layout.split(remaining));
        shares.zip(&self.layout.parts).for_each(|((x, remaining), part)| {
            vectorised(
                #[inline(always)]
                || self.backward_rows(part.clone(), x, remaining, part.start),
            );
        });
    }

    /// `x` and `rest` begin at row `first`.
    #[inline(always)]
    fn forward_rows<const N: usize>(
        &self,
        rows: Range<usize>,
        right: &Vector<B, N>,
        x: &mut Vector<B, N>,
        rest: &mut Vector<B, N>,
        first: usize,
    ) {
        for row in rows {
            let range = self.pattern.range(row);
            let columns = self.pattern.columns(row);
            let blocks = &self.lower[range];
            let mut sum = right[row];
            for (&column, block) in columns.iter().zip(blocks) {
                subtract_product(&mut sum, block, &x[column as usize - first]);
            }
            let mut solved = [[0.0; N]; B];
            add_product(&mut solved, &self.inverse_diagonal[row], &sum);
            x[row - first] = solved;
            rest[row - first] = [[0.0; N]; B];
            for (&column, block) in columns.iter().zip(blocks) {
                subtract_transposed(&mut rest[column as usize - first], block, &solved);
            }
        }
    }

    /// `x` and `remaining` begin at row `first`.
    #[inline(always)]
    fn backward_rows<const N: usize>(
        &self,
        rows: Range<usize>,
        x: &mut Vector<B, N>,
        remaining: &mut Vector<B, N>,
        first: usize,
    ) {
        for row in rows.rev() {
            let range = self.pattern.range(row);
            let columns = self.pattern.columns(row);
            let blocks = &self.lower[range];
            let mut sum = remaining[row - first];
            for (&column, block) in columns.iter().zip(blocks) {
                subtract_product(&mut sum, block, &x[column as usize - first]);
            }
            let mut solved = [[0.0; N]; B];
            add_product(&mut solved, &self.inverse_diagonal[row], &sum);
            x[row - first] = solved;
            for (&column, block) in columns.iter().zip(blocks) {
                subtract_transposed(&mut remaining[column as usize - first], block, &solved);
            }
        }
    }
}
