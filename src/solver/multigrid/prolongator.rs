//! From rigid movements of aggregates to the unknowns of their rows, and back.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::super::LinearSystem;
use super::aggregation::{NONE, aggregate};
use super::rows::{BlockRows, CoarseMatrix, Dense};
use super::{FIRST_AGGREGATE, LATER_AGGREGATE};

/// Damping of the Jacobi step that smooths the weights.
const DAMPING: f64 = 0.85;

/// Weights below this are dropped and their row scaled back to its sum.
const SMALL: f64 = 0.03;

/// Blocks P_iI = w_iI T_i(I): from the six movements of an aggregate to the B unknowns of a row.
pub(super) struct Prolongator<const B: usize> {
    row_start: Vec<usize>,
    aggregates: Vec<u32>,
    blocks: Vec<[[f32; 6]; B]>,
    /// The points about which aggregates turn.
    pub centres: Vec<Vector3<f64>>,
}

/// Scalar weights of a partition of unity, row by row.
struct Weights {
    row_start: Vec<usize>,
    entries: Vec<(u32, f64)>,
    /// The mean position of each aggregate.
    centres: Vec<Vector3<f64>>,
}

impl Prolongator<3> {
    /// From displacements in mm, of which some are held and some are written in axes of their own.
    pub fn finest(system: &LinearSystem) -> Self {
        let held = |row: usize| &system.held[3 * row..3 * row + 3];
        let whole = FullTies { system };
        let weights = Weights::new(
            system,
            system.positions,
            FIRST_AGGREGATE,
            |row| !held(row).iter().all(|held| *held),
            |row, visit| whole.visit(row, visit),
        );
        weights.into_prolongator(
            |row, arm, weight| {
                let turn = -arm.cross_matrix();
                let axes = system.axes.get(&row).map_or_else(Matrix3::identity, Matrix3::transpose);
                let turned = axes * turn;
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        let value = if j < 3 { axes[(i, j)] } else { turned[(i, j - 3)] };
                        if held(row)[i] { 0.0 } else { (weight * value) as f32 }
                    })
                })
            },
            system.positions,
        )
    }
}

/// Ties of the finest level with those to held rows kept, which draw weights to zero there.
struct FullTies<'a> {
    system: &'a LinearSystem<'a>,
}

impl FullTies<'_> {
    fn visit(&self, row: usize, visit: &mut dyn FnMut(usize, f64)) {
        for (column, block) in self.system.matrix.row(row).filter(|(column, _)| *column != row) {
            visit(column, (-(block[0] + block[4] + block[8])).max(0.0));
        }
    }
}

impl Prolongator<6> {
    /// From rigid movements of aggregates about their centres.
    pub fn coarse(matrix: &CoarseMatrix, positions: &[Vector3<f64>]) -> Self {
        let weights = Weights::new(
            matrix,
            positions,
            LATER_AGGREGATE,
            |_| true,
            |row, visit| {
                matrix.ties(row).for_each(|(column, tie)| visit(column, tie));
            },
        );
        weights.into_prolongator(
            |_, arm, weight| {
                let turn = -arm.cross_matrix();
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        let value = match (i < 3, j < 3) {
                            (true, false) => turn[(i, j - 3)],
                            (false, true) => 0.0,
                            _ => f64::from(u8::from(i == j)),
                        };
                        (weight * value) as f32
                    })
                })
            },
            positions,
        )
    }
}

impl Weights {
    /// w = (I - omega D^-1 L) w_0, with w_0 one on the row's own aggregate.
    fn new<const B: usize>(
        matrix: &impl BlockRows<B>,
        positions: &[Vector3<f64>],
        size: usize,
        takes_part: impl Fn(usize) -> bool,
        ties: impl Fn(usize, &mut dyn FnMut(usize, f64)),
    ) -> Self {
        let (group, count) = aggregate(matrix, size, &takes_part);
        let mut weights = Weights {
            row_start: vec![0],
            entries: Vec::new(),
            centres: centres(&group, count, positions),
        };
        let mut row_weights: Vec<(u32, f64)> = Vec::new();
        for row in 0..matrix.rows() {
            row_weights.clear();
            if group[row] != NONE {
                smooth(row, &group, &ties, &mut row_weights);
            }
            weights.entries.extend_from_slice(&row_weights);
            weights.row_start.push(weights.entries.len());
        }
        weights
    }

    fn into_prolongator<const B: usize>(
        self,
        block: impl Fn(usize, &Vector3<f64>, f64) -> [[f32; 6]; B],
        positions: &[Vector3<f64>],
    ) -> Prolongator<B> {
        let mut blocks = Vec::with_capacity(self.entries.len());
        for (row, position) in positions.iter().enumerate() {
            let entries = self.row_start[row]..self.row_start[row + 1];
            for &(aggregate, weight) in &self.entries[entries] {
                let arm = position - self.centres[aggregate as usize];
                blocks.push(block(row, &arm, weight));
            }
        }
        let aggregates = self.entries.iter().map(|&(aggregate, _)| aggregate).collect();
        Prolongator { row_start: self.row_start, aggregates, blocks, centres: self.centres }
    }
}

fn centres(group: &[u32], count: usize, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut sums = vec![(Vector3::zeros(), 0.0); count];
    for (&group, position) in group.iter().zip(positions).filter(|(group, _)| **group != NONE) {
        let (sum, members) = &mut sums[group as usize];
        *sum += position;
        *members += 1.0;
    }
    sums.into_iter().map(|(sum, members)| sum / members).collect()
}

fn smooth(
    row: usize,
    group: &[u32],
    ties: &impl Fn(usize, &mut dyn FnMut(usize, f64)),
    weights: &mut Vec<(u32, f64)>,
) {
    let mut sum = 0.0;
    let mut add = |aggregate: u32, weight: f64| match weights
        .iter_mut()
        .find(|(known, _)| *known == aggregate)
    {
        Some((_, total)) => *total += weight,
        None => weights.push((aggregate, weight)),
    };
    add(group[row], 0.0);
    ties(row, &mut |column, tie| {
        sum += tie;
        if group[column] != NONE {
            add(group[column], tie);
        }
    });
    let scale = if sum > 0.0 { DAMPING / sum } else { 0.0 };
    weights.iter_mut().for_each(|(_, weight)| *weight *= scale);
    let own = weights.iter_mut().find(|(aggregate, _)| *aggregate == group[row]);
    own.expect("a row has a weight for its own aggregate").1 +=
        if sum > 0.0 { 1.0 - DAMPING } else { 1.0 };
    let before: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.retain(|(_, weight)| *weight >= SMALL);
    let after: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.iter_mut().for_each(|(_, weight)| *weight *= before / after);
    weights.sort_unstable_by_key(|(aggregate, _)| *aggregate);
}

impl<const B: usize> Prolongator<B> {
    fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[[f32; 6]; B])> {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.aggregates[range.clone()].iter().map(|&a| a as usize).zip(&self.blocks[range])
    }

    /// P^T residual.
    pub fn restrict(&self, residual: &[f32]) -> Vec<f32> {
        let mut coarse = vec![0.0; 6 * self.centres.len()];
        for row in 0..self.row_start.len() - 1 {
            for (aggregate, block) in self.row(row) {
                let sums = &mut coarse[6 * aggregate..6 * aggregate + 6];
                for (weights, value) in block.iter().zip(&residual[B * row..B * row + B]) {
                    for (sum, weight) in sums.iter_mut().zip(weights) {
                        *sum += weight * value;
                    }
                }
            }
        }
        coarse
    }

    /// P coarse.
    pub fn prolong(&self, coarse: &[f32]) -> Vec<f32> {
        let mut fine = vec![0.0; B * (self.row_start.len() - 1)];
        for row in 0..self.row_start.len() - 1 {
            for (aggregate, block) in self.row(row) {
                let values = &coarse[6 * aggregate..6 * aggregate + 6];
                for (sum, weights) in fine[B * row..B * row + B].iter_mut().zip(block) {
                    *sum += weights.iter().zip(values).map(|(w, v)| w * v).sum::<f32>();
                }
            }
        }
        fine
    }

    /// P^T A P: first A P row by row, then the rows of each aggregate.
    pub fn galerkin(&self, matrix: &impl BlockRows<B>) -> CoarseMatrix {
        let scratch = || vec![usize::MAX; self.centres.len()];
        let products: Vec<Vec<(u32, Wide<B>)>> = (0..matrix.rows())
            .into_par_iter()
            .map_init(scratch, |place, row| self.product_row(matrix, row, place))
            .collect();
        let rows: Vec<Vec<(u32, Dense<6>)>> = self
            .rows_of_aggregates()
            .par_iter()
            .map_init(scratch, |place, rows| self.galerkin_row(&products, rows, place))
            .collect();
        let mut coarse =
            CoarseMatrix { row_start: vec![0], columns: Vec::new(), blocks: Vec::new() };
        for row in rows {
            coarse.columns.extend(row.iter().map(|(column, _)| *column));
            coarse.blocks.extend(row.into_iter().map(|(_, block)| block));
            coarse.row_start.push(coarse.columns.len());
        }
        coarse
    }

    /// For each aggregate the rows it moves and the place of its block.
    fn rows_of_aggregates(&self) -> Vec<Vec<(u32, usize)>> {
        let mut rows_of = vec![Vec::new(); self.centres.len()];
        for row in 0..self.row_start.len() - 1 {
            for place in self.row_start[row]..self.row_start[row + 1] {
                rows_of[self.aggregates[place] as usize].push((row as u32, place));
            }
        }
        rows_of
    }

    /// sum_j A_ij P_jJ for one row i and all J. `place` is scratch: all `usize::MAX`.
    fn product_row(
        &self,
        matrix: &impl BlockRows<B>,
        row: usize,
        place: &mut [usize],
    ) -> Vec<(u32, Wide<B>)> {
        let mut sums: Vec<(u32, Wide<B>)> = Vec::new();
        for (column, a) in matrix.row(row) {
            for (aggregate, p) in self.row(column) {
                if place[aggregate] == usize::MAX {
                    place[aggregate] = sums.len();
                    sums.push((aggregate as u32, [[0.0; 6]; B]));
                }
                for (sum, a) in sums[place[aggregate]].1.iter_mut().zip(&a) {
                    for (factor, p) in a.iter().zip(p) {
                        add_scaled(sum, *factor, p);
                    }
                }
            }
        }
        for (aggregate, _) in &sums {
            place[*aggregate as usize] = usize::MAX;
        }
        sums
    }

    /// sum_i P_iI^T (A P)_iJ for one I and all J. `place` is scratch: all `usize::MAX`.
    fn galerkin_row(
        &self,
        products: &[Vec<(u32, Wide<B>)>],
        rows: &[(u32, usize)],
        place: &mut [usize],
    ) -> Vec<(u32, Dense<6>)> {
        let mut sums: Vec<(u32, Dense<6>)> = Vec::new();
        for &(row, own) in rows {
            for (aggregate, product) in &products[row as usize] {
                let at = &mut place[*aggregate as usize];
                if *at == usize::MAX {
                    *at = sums.len();
                    sums.push((*aggregate, [[0.0; 6]; 6]));
                }
                for (p, product) in self.blocks[own].iter().zip(product) {
                    for (sum, factor) in sums[*at].1.iter_mut().zip(p) {
                        for (sum, value) in sum.iter_mut().zip(product) {
                            *sum += f64::from(*factor) * value;
                        }
                    }
                }
            }
        }
        for (aggregate, _) in &sums {
            place[*aggregate as usize] = usize::MAX;
        }
        sums.sort_unstable_by_key(|(aggregate, _)| *aggregate);
        sums
    }
}

/// B rows of six movements.
type Wide<const B: usize> = [[f64; 6]; B];

fn add_scaled(sum: &mut [f64; 6], factor: f64, values: &[f32; 6]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += factor * f64::from(*value);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::solver::BlockMatrix;

    /// A chain of 90 rows along a helix, tied to their neighbours; row 40 has axes of its own.
    fn chain() -> (BlockMatrix, Vec<Vector3<f64>>, BTreeMap<usize, Matrix3<f64>>) {
        let cliques: Vec<[u32; 2]> = (0..89).map(|row| [row, row + 1]).collect();
        let mut matrix = BlockMatrix::from_cliques(90, cliques.iter().map(<[u32; 2]>::as_slice));
        for [a, b] in cliques.iter().map(|pair| pair.map(|row| row as usize)) {
            for k in 0..3 {
                matrix.block_mut(a, a)[4 * k] += 1.0;
                matrix.block_mut(b, b)[4 * k] += 1.0;
                matrix.block_mut(a, b)[4 * k] -= 1.0;
                matrix.block_mut(b, a)[4 * k] -= 1.0;
            }
        }
        let position = |row: u32| {
            let angle = f64::from(row) * 0.3;
            Vector3::new(5.0 * angle.cos(), 5.0 * angle.sin(), 0.2 * f64::from(row))
        };
        let turned = nalgebra::Rotation3::from_euler_angles(0.4, -0.7, 1.1).into_inner();
        (matrix, (0..90).map(position).collect(), BTreeMap::from([(40, turned)]))
    }

    #[test]
    fn a_rigid_movement_of_all_aggregates_is_that_movement_of_all_rows() {
        let (matrix, positions, axes) = chain();
        let (held, right_hand_side) = (vec![false; 270], vec![0.0; 270]);
        let system = LinearSystem {
            matrix: &matrix,
            held: &held,
            right_hand_side: &right_hand_side,
            positions: &positions,
            axes: &axes,
        };
        let (shift, turn) = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.1, 0.2, -0.3));
        let moved = |x: &Vector3<f64>| shift + turn.cross(x);
        let first = Prolongator::finest(&system);
        assert!(first.centres.len() > 2, "the chain has several aggregates");
        let coarse: Vec<f32> = first
            .centres
            .iter()
            .flat_map(|centre| moved(centre).iter().chain(&turn).copied().collect::<Vec<_>>())
            .map(|value| value as f32)
            .collect();
        let fine = first.prolong(&coarse);
        for (row, position) in positions.iter().enumerate() {
            let frame = axes.get(&row).map_or_else(Matrix3::identity, Matrix3::transpose);
            let expected = frame * moved(position);
            for (k, value) in expected.iter().enumerate() {
                let found = f64::from(fine[3 * row + k]);
                assert!((found - value).abs() < 1e-5, "row {row}: {found} instead of {value}");
            }
        }
    }
}
