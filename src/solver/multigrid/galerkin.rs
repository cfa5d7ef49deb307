//! The coarse matrix P^T A P.
//!
//! With T_i = [ I | R(x_i - o) ] about one origin o for all rows, P_iI = w_iI T_i S_I, where S_I moves the
//! point of reference from o to the centre of the aggregate. So the sum over rows needs no arms:
//! (P^T A P)_IJ = S_I^T ( sum_ij w_iI w_jJ T_i^T A_ij T_j ) S_J. A is read as L + D/2 and the result
//! added to its transpose.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Matrix6, Vector3};
use rayon::prelude::*;

use super::prolongator::{Weight, Weights};
use crate::solver::cliques::{Cliques, CliquesOfRow};
use crate::solver::half_matrix::{HalfMatrix, Pattern};
use crate::solver::layout::Layout;

/// B rows of six movements.
pub(super) type Wide<const B: usize> = [[f64; 6]; B];

/// For each aggregate the aggregates it meets, and a block for each.
struct Accumulator {
    partners: Vec<Vec<u32>>,
    blocks: Vec<Vec<[[f64; 6]; 6]>>,
}

impl Accumulator {
    fn new(aggregates: usize) -> Self {
        Accumulator { partners: vec![Vec::new(); aggregates], blocks: vec![Vec::new(); aggregates] }
    }

    fn block(&mut self, aggregate: u32, partner: u32) -> &mut [[f64; 6]; 6] {
        let partners = &mut self.partners[aggregate as usize];
        let blocks = &mut self.blocks[aggregate as usize];
        let at = partners.iter().position(|&known| known == partner).unwrap_or_else(|| {
            partners.push(partner);
            blocks.push([[0.0; 6]; 6]);
            partners.len() - 1
        });
        &mut blocks[at]
    }

    fn entries(&self) -> impl Iterator<Item = (usize, u32, &[[f64; 6]; 6])> {
        self.partners.iter().zip(&self.blocks).enumerate().flat_map(
            |(aggregate, (partners, blocks))| {
                partners
                    .iter()
                    .zip(blocks)
                    .map(move |(&partner, block)| (aggregate, partner, block))
            },
        )
    }
}

/// The coarse matrix over aggregates in a layout of its own.
pub(super) struct Coarse {
    pub matrix: HalfMatrix<f64, 6>,
    pub layout: Layout,
}

/// `basis` gives T_i about `origin`, in the axes of the row, with zeros where it is held.
pub(super) fn galerkin<const B: usize>(
    matrix: &HalfMatrix<f64, B>,
    layout: &Layout,
    weights: &Weights,
    basis: &(impl Fn(usize) -> Wide<B> + Sync),
    origin: &Vector3<f64>,
) -> Coarse {
    let mut ranges = layout.parts.clone();
    ranges.push(layout.separator());
    let sums: Vec<Accumulator> =
        ranges.into_par_iter().map(|rows| accumulate(matrix, rows, weights, basis)).collect();
    let mut pairs = Cliques::default();
    for (aggregate, partner, _) in sums.iter().flat_map(Accumulator::entries) {
        pairs.push([aggregate as u32, partner]);
    }
    let aggregates = weights.aggregates;
    let around = CliquesOfRow::new(&pairs, aggregates);
    let layout = Layout::new(&pairs, &around, &vec![false; aggregates], 6);
    let renumbered = pairs.renumbered(&layout.clique_order, &layout.place);
    let around = CliquesOfRow::new(&renumbered, aggregates);
    let pattern = Arc::new(Pattern::new(&renumbered, &around, aggregates));
    let mut coarse = HalfMatrix::zeros(pattern);
    let shift: Vec<Matrix6<f64>> =
        weights.centres.iter().map(|centre| shift(&(origin - centre))).collect();
    for (aggregate, partner, block) in sums.iter().flat_map(Accumulator::entries) {
        let block = Matrix6::from_fn(|i, j| block[i][j]);
        let moved = shift[aggregate].transpose() * block * shift[partner as usize];
        let (row, column) =
            (layout.place[aggregate] as usize, layout.place[partner as usize] as usize);
        let target = coarse.block_mut(row.max(column), row.min(column));
        for i in 0..6 {
            for j in 0..6 {
                if row >= column {
                    target[i][j] += moved[(i, j)];
                }
                if row <= column {
                    target[i][j] += moved[(j, i)];
                }
            }
        }
    }
    Coarse { matrix: coarse, layout }
}

/// S_I for the arm from the centre to the origin: the same movement told about the origin.
fn shift(arm: &Vector3<f64>) -> Matrix6<f64> {
    let mut shift = Matrix6::identity();
    shift.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    shift
}

/// The share of a range of rows.
fn accumulate<const B: usize>(
    matrix: &HalfMatrix<f64, B>,
    rows: Range<usize>,
    weights: &Weights,
    basis: &impl Fn(usize) -> Wide<B>,
) -> Accumulator {
    let mut sums = Accumulator::new(weights.aggregates);
    let mut products: Vec<(u32, Wide<B>)> = Vec::new();
    for row in rows {
        products.clear();
        let own = basis(row);
        let half = matrix.diagonal[row].map(|values| values.map(|value| 0.5 * value));
        add_product(&mut products, &half, &own, weights.of(row));
        for (column, block) in matrix.lower_row(row) {
            add_product(&mut products, block, &basis(column), weights.of(column));
        }
        for (partner, product) in &products {
            let block = transposed_product(&own, product);
            for &Weight { partner: aggregate, weight } in weights.of(row) {
                let sum = sums.block(aggregate, *partner);
                for (sum, values) in sum.iter_mut().zip(&block) {
                    for (sum, value) in sum.iter_mut().zip(values) {
                        *sum += f64::from(weight) * value;
                    }
                }
            }
        }
    }
    sums
}

/// Adds w_jJ A_ij T_j for all J.
fn add_product<const B: usize>(
    products: &mut Vec<(u32, Wide<B>)>,
    block: &[[f64; B]; B],
    basis: &Wide<B>,
    weights: &[Weight],
) {
    let mut product = [[0.0; 6]; B];
    for r in 0..B {
        for c in 0..B {
            for k in 0..6 {
                product[r][k] += block[r][c] * basis[c][k];
            }
        }
    }
    for &Weight { partner, weight } in weights {
        let at = products.iter().position(|(known, _)| *known == partner).unwrap_or_else(|| {
            products.push((partner, [[0.0; 6]; B]));
            products.len() - 1
        });
        for (sum, values) in products[at].1.iter_mut().zip(&product) {
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += f64::from(weight) * value;
            }
        }
    }
}

/// T^T product.
fn transposed_product<const B: usize>(basis: &Wide<B>, product: &Wide<B>) -> [[f64; 6]; 6] {
    let mut block = [[0.0; 6]; 6];
    for (basis, product) in basis.iter().zip(product) {
        for i in 0..6 {
            for k in 0..6 {
                block[i][k] += basis[i] * product[k];
            }
        }
    }
    block
}
