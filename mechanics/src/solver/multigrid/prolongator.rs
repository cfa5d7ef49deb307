//! Prolongation from rigid movements of aggregates to the unknowns of their rows, and restriction back.
//!
//! P_iI = w_iI [ I | R(x_i - c_I) ]: scalar weights that add up to one in each row, times the exact rigid
//! movement of aggregate I about its centre. Only the weights are stored; arms come from positions.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::aggregation::aggregate;
use super::smoother::Vector;
use super::strength_of_connection::StrengthOfConnection;
use crate::rows::Rows;
use crate::solver::lanes::Lanes;
use crate::solver::row_ordering::RowOrdering;
use crate::vectorised::vectorised;

/// Damping of the Jacobi step that smooths the weights.
const DAMPING: f32 = 0.85;

/// Weights below this are dropped and their row scaled back to its sum.
const SMALL: f32 = 0.03;

/// Rows that one thread takes at a time.
const CHUNK: usize = 4096;

/// A partner and its weight.
#[derive(Clone, Copy)]
pub(super) struct Weight {
    pub partner: u32,
    pub weight: f32,
}

pub(super) struct Prolongator {
    /// For each row its aggregates.
    weights: Rows<Weight>,
    ordering: Arc<RowOrdering>,
    /// Positions and centres are told from a point in their midst, so that f32 loses little.
    positions: Vec<[f32; 3]>,
    centres: Vec<[f32; 3]>,
}

/// Smoothed weights before aggregates have their final numbers.
pub(super) struct Weights {
    of_row: Rows<Weight>,
    pub aggregates: usize,
    pub centres: Vec<Vector3<f64>>,
}

impl Weights {
    /// w = (I - omega D^-1 L) w_0, with w_0 one on the row's own aggregate and couplings to constrained rows kept in
    /// D, which draw weights to zero there.
    pub fn new(strength: &StrengthOfConnection, positions: &[Vector3<f64>], size: usize) -> Self {
        let (group, aggregates) = aggregate(strength, size);
        let chunks: Vec<Rows<Weight>> = (0..strength.rows().div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut weights = Rows::with_room(CHUNK, 3 * CHUNK);
                let mut of_row: Vec<Weight> = Vec::new();
                for row in chunk * CHUNK..((chunk + 1) * CHUNK).min(strength.rows()) {
                    smooth(row, &group, strength, &mut of_row);
                    weights.push(of_row.iter().copied());
                }
                weights
            })
            .collect();
        let centres = centres(&group, aggregates, positions);
        Weights { of_row: Rows::joined(chunks), aggregates, centres }
    }

    pub fn of(&self, row: usize) -> &[Weight] {
        self.of_row.row(row)
    }

    /// `place` renumbers the aggregates. Positions are those of the rows of `row_ordering`.
    pub fn into_prolongator(
        mut self,
        place: &[u32],
        positions: &[Vector3<f64>],
        ordering: Arc<RowOrdering>,
        origin: &Vector3<f64>,
    ) -> Prolongator {
        for weight in self.of_row.entries_mut() {
            weight.partner = place[weight.partner as usize];
        }
        let single = |p: &Vector3<f64>| <[f64; 3]>::from(p - origin).map(|value| value as f32);
        let mut centres = vec![[0.0; 3]; self.aggregates];
        for (centre, &place) in self.centres.iter().zip(place) {
            centres[place as usize] = single(centre);
        }
        let positions = positions.iter().map(single).collect();
        Prolongator { weights: self.of_row, ordering, positions, centres }
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

fn smooth(row: usize, group: &[u32], strength: &StrengthOfConnection, weights: &mut Vec<Weight>) {
    weights.clear();
    weights.push(Weight { partner: group[row], weight: 0.0 });
    let mut sum = strength.held[row];
    for (column, tie) in strength.of(row) {
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
        let (weights, rows) = (self.weights.entries().len(), self.positions.len());
        (8 * weights + 16 * rows + 12 * self.centres.len()) as f64 / 1e6
    }

    /// What `restrict` needs: a sum of its own for each part and for the separator.
    pub fn partial_sums<const N: usize>(&self) -> Vec<Vec<Lanes<f32, 6, N>>> {
        vec![vec![[[0.0; N]; 6]; self.centres.len()]; self.ordering.parts.len() + 1]
    }

    /// P^T residual. Moments are summed about the origin and then taken about each centre.
    pub fn restrict<const B: usize, const N: usize>(
        &self,
        residual: &Vector<B, N>,
        partial: &mut [Vec<Lanes<f32, 6, N>>],
        coarse: &mut Vector<6, N>,
    ) {
        let separator = self.ordering.separator();
        let ranges = self.ordering.parts.par_iter().cloned().chain([separator].into_par_iter());
        partial.par_iter_mut().zip(ranges).for_each(|(sums, rows)| {
            vectorised(
                #[inline(always)]
                || self.restrict_rows(rows.clone(), residual, sums),
            );
        });
        for (aggregate, (total, centre)) in coarse.iter_mut().zip(&self.centres).enumerate() {
            *total = [[0.0; N]; 6];
            for sums in &*partial {
                for (total, sum) in total.iter_mut().zip(&sums[aggregate]) {
                    for n in 0..N {
                        total[n] += sum[n];
                    }
                }
            }
            for c in 0..3 {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                let (force_a, force_b) = (total[a], total[b]);
                for (n, moment) in total[3 + c].iter_mut().enumerate() {
                    *moment -= centre[a] * force_b[n] - centre[b] * force_a[n];
                }
            }
        }
    }

    #[inline(always)]
    fn restrict_rows<const B: usize, const N: usize>(
        &self,
        rows: Range<usize>,
        residual: &Vector<B, N>,
        sums: &mut Vector<6, N>,
    ) {
        sums.fill([[0.0; N]; 6]);
        for row in rows {
            let (force, x) = (&residual[row], &self.positions[row]);
            let mut own = [[0.0; N]; 6];
            for c in 0..3 {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                own[c] = force[c];
                for n in 0..N {
                    own[3 + c][n] = x[a] * force[b][n] - x[b] * force[a][n];
                    if B == 6 {
                        own[3 + c][n] += force[3 + c][n];
                    }
                }
            }
            for &Weight { partner, weight } in self.weights.row(row) {
                for (sum, own) in sums[partner as usize].iter_mut().zip(&own) {
                    for n in 0..N {
                        sum[n] += weight * own[n];
                    }
                }
            }
        }
    }

    /// fine += P coarse. Leaves the movements of the aggregates taken about the origin.
    pub fn add_prolonged<const B: usize, const N: usize>(
        &self,
        coarse: &mut Vector<6, N>,
        fine: &mut Vector<B, N>,
    ) {
        for (movement, centre) in coarse.iter_mut().zip(&self.centres) {
            for c in 0..3 {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                let (turn_a, turn_b) = (movement[3 + a], movement[3 + b]);
                for (n, shift) in movement[c].iter_mut().enumerate() {
                    *shift -= turn_a[n] * centre[b] - turn_b[n] * centre[a];
                }
            }
        }
        let coarse = &*coarse;
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
        let mut own = [[0.0; N]; 6];
        for &Weight { partner, weight } in self.weights.row(row) {
            for (own, movement) in own.iter_mut().zip(&coarse[partner as usize]) {
                for n in 0..N {
                    own[n] += weight * movement[n];
                }
            }
        }
        let x = &self.positions[row];
        for c in 0..3 {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            for n in 0..N {
                values[c][n] += own[c][n] + (own[3 + a][n] * x[b] - own[3 + b][n] * x[a]);
                if B == 6 {
                    values[3 + c][n] += own[3 + c][n];
                }
            }
        }
    }
}
