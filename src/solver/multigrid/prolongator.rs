//! From rigid movements of aggregates to the unknowns of their rows, and back.
//!
//! P_iI = w_iI [ I | R(x_i - c_I) ]: scalar weights that add up to one in each row, times the exact rigid
//! movement of aggregate I about its centre. Only the weights are stored; arms come from positions.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::aggregation::aggregate;
use super::smoother::Vector;
use super::ties::Ties;
use crate::solver::lanes::Lanes;
use crate::solver::vectorised::vectorised;

/// Damping of the Jacobi step that smooths the weights.
const DAMPING: f32 = 0.85;

/// Weights below this are dropped and their row scaled back to its sum.
const SMALL: f32 = 0.03;

/// Rows that one thread takes at a time.
const CHUNK: usize = 4096;

/// A partner and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weight {
    pub partner: u32,
    pub weight: f32,
}

pub(super) struct Prolongator {
    /// For each row its aggregates.
    by_row: Table,
    /// For each aggregate its rows.
    by_aggregate: Table,
    positions: Vec<[f32; 3]>,
    centres: Vec<[f32; 3]>,
}

/// Lists of weights.
#[derive(Clone)]
struct Table {
    starts: Vec<u32>,
    weights: Vec<Weight>,
}

impl Table {
    fn of(&self, index: usize) -> &[Weight] {
        &self.weights[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// The same weights seen from the partners.
    fn transposed(&self, partners: usize) -> Table {
        let mut starts = vec![0_u32; partners + 1];
        for weight in &self.weights {
            starts[weight.partner as usize + 1] += 1;
        }
        for partner in 0..partners {
            starts[partner + 1] += starts[partner];
        }
        let mut next = starts.clone();
        let mut weights = vec![Weight { partner: 0, weight: 0.0 }; self.weights.len()];
        for row in 0..self.starts.len() - 1 {
            for &Weight { partner, weight } in self.of(row) {
                weights[next[partner as usize] as usize] = Weight { partner: row as u32, weight };
                next[partner as usize] += 1;
            }
        }
        Table { starts, weights }
    }
}

/// Smoothed weights before aggregates have their final numbers.
pub(super) struct Weights {
    table: Table,
    pub aggregates: usize,
    pub centres: Vec<Vector3<f64>>,
}

impl Weights {
    /// w = (I - omega D^-1 L) w_0, with w_0 one on the row's own aggregate and ties to held rows kept in
    /// D, which draw weights to zero there.
    pub fn new(ties: &Ties, positions: &[Vector3<f64>], size: usize) -> Self {
        let (group, aggregates) = aggregate(ties, size);
        let mut table = Table { starts: vec![0], weights: Vec::with_capacity(3 * ties.rows()) };
        let mut row_weights: Vec<Weight> = Vec::new();
        for row in 0..ties.rows() {
            smooth(row, &group, ties, &mut row_weights);
            table.weights.extend_from_slice(&row_weights);
            table.starts.push(table.weights.len() as u32);
        }
        Weights { table, aggregates, centres: centres(&group, aggregates, positions) }
    }

    pub fn of(&self, row: usize) -> &[Weight] {
        self.table.of(row)
    }

    /// `place` renumbers the aggregates.
    pub fn into_prolongator(mut self, place: &[u32], positions: &[Vector3<f64>]) -> Prolongator {
        for weight in &mut self.table.weights {
            weight.partner = place[weight.partner as usize];
        }
        let single = |p: &Vector3<f64>| [p.x as f32, p.y as f32, p.z as f32];
        let mut centres = vec![[0.0; 3]; self.aggregates];
        for (centre, &place) in self.centres.iter().zip(place) {
            centres[place as usize] = single(centre);
        }
        Prolongator {
            by_aggregate: self.table.transposed(self.aggregates),
            by_row: self.table,
            positions: positions.iter().map(single).collect(),
            centres,
        }
    }
}

fn centres(group: &[u32], count: usize, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut sums = vec![(Vector3::zeros(), 0.0); count];
    for (&group, position) in group.iter().zip(positions) {
        let (sum, members) = &mut sums[group as usize];
        *sum += position;
        *members += 1.0;
    }
    sums.into_iter().map(|(sum, members)| sum / members).collect()
}

fn smooth(row: usize, group: &[u32], ties: &Ties, weights: &mut Vec<Weight>) {
    weights.clear();
    weights.push(Weight { partner: group[row], weight: 0.0 });
    let mut sum = ties.held[row];
    for (column, tie) in ties.of(row) {
        sum += tie;
        match weights.iter_mut().find(|known| known.partner == group[column]) {
            Some(known) => known.weight += tie,
            None => weights.push(Weight { partner: group[column], weight: tie }),
        }
    }
    let scale = if sum > 0.0 { DAMPING / sum } else { 0.0 };
    weights.iter_mut().for_each(|weight| weight.weight *= scale);
    weights[0].weight += if sum > 0.0 { 1.0 - DAMPING } else { 1.0 };
    let total = |weights: &[Weight]| weights.iter().map(|weight| weight.weight).sum::<f32>();
    let before = total(weights);
    weights.retain(|weight| weight.weight >= SMALL);
    let after = total(weights);
    weights.iter_mut().for_each(|weight| weight.weight *= before / after);
    weights.sort_unstable_by_key(|weight| weight.partner);
}

impl Prolongator {
    pub fn megabytes(&self) -> f64 {
        (16 * self.by_row.weights.len() + 16 * self.positions.len() + 16 * self.centres.len())
            as f64
            / 1e6
    }

    /// P^T residual.
    pub fn restrict<const B: usize, const N: usize>(
        &self,
        residual: &Vector<B, N>,
        coarse: &mut Vector<6, N>,
    ) {
        coarse.par_chunks_mut(CHUNK / 16).enumerate().for_each(|(chunk, coarse)| {
            vectorised(
                #[inline(always)]
                || {
                    for (local, sums) in coarse.iter_mut().enumerate() {
                        *sums = self.restrict_to(chunk * (CHUNK / 16) + local, residual);
                    }
                },
            );
        });
    }

    #[inline(always)]
    fn restrict_to<const B: usize, const N: usize>(
        &self,
        aggregate: usize,
        residual: &Vector<B, N>,
    ) -> Lanes<f32, 6, N> {
        let centre = self.centres[aggregate];
        let mut sums = [[0.0; N]; 6];
        for &Weight { partner, weight } in self.by_aggregate.of(aggregate) {
            let arm = arm(&self.positions[partner as usize], &centre);
            let force = &residual[partner as usize];
            for n in 0..N {
                let f = [weight * force[0][n], weight * force[1][n], weight * force[2][n]];
                for c in 0..3 {
                    sums[c][n] += f[c];
                    let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                    sums[3 + c][n] += arm[a] * f[b] - arm[b] * f[a];
                    if B == 6 {
                        sums[3 + c][n] += weight * force[3 + c][n];
                    }
                }
            }
        }
        sums
    }

    /// fine += P coarse.
    pub fn add_prolonged<const B: usize, const N: usize>(
        &self,
        coarse: &Vector<6, N>,
        fine: &mut Vector<B, N>,
    ) {
        fine.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, fine)| {
            vectorised(
                #[inline(always)]
                || {
                    for (local, values) in fine.iter_mut().enumerate() {
                        self.prolong_to(chunk * CHUNK + local, coarse, values);
                    }
                },
            );
        });
    }

    #[inline(always)]
    fn prolong_to<const B: usize, const N: usize>(
        &self,
        row: usize,
        coarse: &Vector<6, N>,
        values: &mut Lanes<f32, B, N>,
    ) {
        for &Weight { partner, weight } in self.by_row.of(row) {
            let arm = arm(&self.positions[row], &self.centres[partner as usize]);
            let movement = &coarse[partner as usize];
            for n in 0..N {
                for c in 0..3 {
                    let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                    let turned = movement[3 + a][n] * arm[b] - movement[3 + b][n] * arm[a];
                    values[c][n] += weight * (movement[c][n] + turned);
                    if B == 6 {
                        values[3 + c][n] += weight * movement[3 + c][n];
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn arm(position: &[f32; 3], centre: &[f32; 3]) -> [f32; 3] {
    [position[0] - centre[0], position[1] - centre[1], position[2] - centre[2]]
}
