//! The coarse matrix P^T A P.
//!
//! With T_i = [ I | R(x_i - o) ] about one origin o for all rows, R(d) w = w x d, P_iI = w_iI T_i S_I, where S_I moves the
//! point of reference from o to the centre of the aggregate. So the sum over rows needs no arms:
//! (P^T A P)_IJ = S_I^T ( sum_ij w_iI w_jJ T_i^T A_ij T_j ) S_J. A is read as L + D/2 and the result
//! added to its transpose.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::prolongator::{Weight, Weights};
use crate::solver::element_connectivity::{ElementConnectivity, renumbered};
use crate::solver::half_matrix::{HalfMatrix, Pattern};
use crate::solver::row_ordering::RowOrdering;
use crate::vectorised::vectorised;

/// Aggregates that most aggregates meet below themselves.
const ROOM: usize = 16;

/// B rows of six movements.
pub(super) type RigidRows<const B: usize> = [[f64; 6]; B];

/// For each aggregate the aggregates it meets, and a block for each.
struct Accumulator {
    partners: Vec<Vec<u32>>,
    blocks: Vec<Vec<[[f64; 6]; 6]>>,
}

impl Accumulator {
    fn new(aggregates: usize) -> Self {
        let with_room = |_| Vec::with_capacity(ROOM);
        Accumulator {
            partners: (0..aggregates).map(|_| Vec::with_capacity(ROOM)).collect(),
            blocks: (0..aggregates).map(with_room).collect(),
        }
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

/// The coarse matrix over aggregates in an ordering of its own.
pub(super) struct Coarse {
    pub matrix: HalfMatrix<f64, 6>,
    pub ordering: RowOrdering,
}

/// A level to be made coarser. Positions are those of its rows; `turned` writes a block, given its row and
/// column, along the axes of the coordinates, with zeros where it is held.
pub(super) struct Fine<'a, const B: usize, F> {
    pub matrix: &'a HalfMatrix<f64, B>,
    pub ordering: &'a RowOrdering,
    pub positions: &'a [Vector3<f64>],
    pub origin: Vector3<f64>,
    pub turned: F,
}

/// P^T A P for the prolongator with these weights.
pub(super) fn galerkin<const B: usize, F>(fine: &Fine<B, F>, weights: &Weights) -> Coarse
where
    F: Fn(usize, usize, &[[f64; B]; B]) -> [[f64; B]; B] + Sync,
{
    let ordering = fine.ordering;
    let mut ranges = ordering.parts.clone();
    ranges.push(ordering.separator());
    let sums: Vec<Accumulator> =
        ranges.into_par_iter().map(|rows| accumulate(fine, rows, weights)).collect();
    let mut pairs = ElementConnectivity::default();
    for (aggregate, partner, _) in sums.iter().flat_map(Accumulator::entries) {
        pairs.push([aggregate as u32, partner]);
    }
    let aggregates = weights.aggregates;
    let around = pairs.inverted(aggregates);
    let ordering = RowOrdering::new(&pairs, &around, &vec![false; aggregates], 6, 0);
    let renumbered = renumbered(&pairs, &ordering.element_order, &ordering.place);
    let around = renumbered.inverted(aggregates);
    let pattern = Arc::new(Pattern::new(&renumbered, &around, aggregates));
    let mut coarse = HalfMatrix::zeros(pattern);
    let arm = |aggregate: usize| fine.origin - weights.centres[aggregate];
    for (aggregate, partner, block) in sums.iter().flat_map(Accumulator::entries) {
        let moved = moved(block, &arm(aggregate), &arm(partner as usize));
        let (row, column) =
            (ordering.place[aggregate] as usize, ordering.place[partner as usize] as usize);
        let target = coarse.block_mut(row.max(column), row.min(column));
        for i in 0..6 {
            for j in 0..6 {
                if row >= column {
                    target[i][j] += moved[i][j];
                }
                if row <= column {
                    target[i][j] += moved[j][i];
                }
            }
        }
    }
    Coarse { matrix: coarse, ordering }
}

/// S_I^T block S_J, with S = [ I , -[arm]x ; 0 , I ] for the arm from the centre of an aggregate to the origin: the same
/// movements taken about the centres.
fn moved(block: &[[f64; 6]; 6], arm: &Vector3<f64>, other_arm: &Vector3<f64>) -> [[f64; 6]; 6] {
    let mut moved = *block;
    for row in &mut moved {
        for c in 0..3 {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            row[3 + c] += other_arm[a] * row[b] - other_arm[b] * row[a];
        }
    }
    let [x, y, z, turns @ ..] = &mut moved;
    let forces = [x, y, z];
    for (c, turn) in turns.iter_mut().enumerate() {
        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
        for (k, turn) in turn.iter_mut().enumerate() {
            *turn += arm[a] * forces[b][k] - arm[b] * forces[a][k];
        }
    }
    moved
}

/// The share of a range of rows.
fn accumulate<const B: usize, F>(
    fine: &Fine<B, F>,
    rows: Range<usize>,
    weights: &Weights,
) -> Accumulator
where
    F: Fn(usize, usize, &[[f64; B]; B]) -> [[f64; B]; B],
{
    let mut sums = Accumulator::new(weights.aggregates);
    let mut products: Vec<(u32, RigidRows<B>)> = Vec::new();
    vectorised(
        #[inline(always)]
        || {
            for row in rows.clone() {
                products.clear();
                let arm = fine.positions[row] - fine.origin;
                let own = (fine.turned)(row, row, &fine.matrix.diagonal[row]);
                let half = own.map(|values| values.map(|value| 0.5 * value));
                add_product(&mut products, &half, &arm, weights.of(row));
                for (column, block) in fine.matrix.lower_row(row) {
                    let block = (fine.turned)(row, column, block);
                    let arm = fine.positions[column] - fine.origin;
                    add_product(&mut products, &block, &arm, weights.of(column));
                }
                for (partner, product) in &products {
                    let block = transposed_product(&arm, product);
                    for &Weight { partner: aggregate, weight } in weights.of(row) {
                        add_scaled(sums.block(aggregate, *partner), f64::from(weight), &block);
                    }
                }
            }
        },
    );
    sums
}

/// Adds w_jJ A_ij T_j for all J, with A T = [ A_u | A_u R + A_w ] for the columns of A that act on
/// displacement and, on coarse levels, on rotation.
#[inline(always)]
fn add_product<const B: usize>(
    products: &mut Vec<(u32, RigidRows<B>)>,
    block: &[[f64; B]; B],
    arm: &Vector3<f64>,
    weights: &[Weight],
) {
    let mut product = [[0.0; 6]; B];
    for (product, values) in product.iter_mut().zip(block) {
        for c in 0..3 {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            product[c] = values[c];
            product[3 + c] = arm[a] * values[b] - arm[b] * values[a];
            if B == 6 {
                product[3 + c] += values[3 + c];
            }
        }
    }
    for &Weight { partner, weight } in weights {
        let at = products.iter().position(|(known, _)| *known == partner).unwrap_or_else(|| {
            products.push((partner, [[0.0; 6]; B]));
            products.len() - 1
        });
        add_scaled(&mut products[at].1, f64::from(weight), &product);
    }
}

#[inline(always)]
fn add_scaled<const B: usize>(sum: &mut RigidRows<B>, factor: f64, values: &RigidRows<B>) {
    for (sum, values) in sum.iter_mut().zip(values) {
        for k in 0..6 {
            sum[k] += factor * values[k];
        }
    }
}

/// T^T product.
#[inline(always)]
fn transposed_product<const B: usize>(arm: &Vector3<f64>, product: &RigidRows<B>) -> [[f64; 6]; 6] {
    let mut block = [[0.0; 6]; 6];
    for c in 0..3 {
        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
        block[c] = product[c];
        for k in 0..6 {
            block[3 + c][k] = arm[a] * product[b][k] - arm[b] * product[a][k];
            if B == 6 {
                block[3 + c][k] += product[3 + c][k];
            }
        }
    }
    block
}
