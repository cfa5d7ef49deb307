//! The second order of a response: a quadratic form in the twelve numbers of each segment, in sixteen bits.
//!
//! u2 = sum_{k <= l} a_k a_l U_kl over all numbers a of all segments, cross terms between segments included: 300 pairs for
//! two segments. Pair p has one scale s_p, the largest component of U_kl over 32767, and is stored as round(U_kl / s_p): a
//! node is off by at most a_k a_l s_p / 2 for each pair. Pairs are in the order (0,0), (0,1), ..., (0,n-1), (1,1), ...
//!
//! What the second order leaves out is told from samples of the third: for each segment the mean length of u3 on the skin that moves
//! for a unit of translation along each axis and of rotation about each axis, tau_j, put together as if the cubic term
//! were the same in every direction, times what probes say against that (`coupling`):
//! e3 = c (sum_j alpha_j^2 tau_j^(2/3))^(3/2), exact along each sampled direction.

use rayon::prelude::*;

pub use super::coupling::pairs;
use super::coupling::{Probed, third_together};
use super::rigid_numbers::{SAMPLES, rigid_numbers};
use super::superposition::{ResponseSegment, coefficients};
use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::prediction::least_moving;
use crate::vectorised::vectorised;

/// Numbers that are summed side by side, whole vectors of them.
const STRETCH: usize = 1536;

/// Pairs that are added in one go.
const TOGETHER: usize = 4;

/// The largest stored integer.
pub const LARGEST: f32 = 32767.0;

/// The second order of a response, and samples of the third.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticForm {
    /// Of the twelve numbers of all segments.
    pub numbers: usize,
    /// [pair][node][xyz], in units of the scale of the pair.
    pub values: Vec<i16>,
    /// For each pair, in mm.
    pub scales: Vec<f32>,
    /// tau for each segment, in mm.
    pub third: Vec<[f64; SAMPLES]>,
    /// Of every three sampled directions; empty where they are put together without it.
    pub coupling: Vec<Probed>,
}

/// Second and third order of a plan, as means over the skin that moves, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeyondLinear {
    /// Of |u2|.
    pub second: f64,
    /// Of |u3|, estimated.
    pub third: f64,
}

/// A column as integers, and its scale.
pub fn quantised(column: &[Vector]) -> (Vec<i16>, f32) {
    let largest = column.iter().map(Vector::amax).fold(0.0, f64::max);
    let scale = (largest / f64::from(LARGEST)) as f32;
    let inverse = if scale > 0.0 { 1.0 / f64::from(scale) } else { 0.0 };
    let limit = f64::from(LARGEST);
    let whole = |value: &f64| (value * inverse).round().clamp(-limit, limit) as i16;
    (column.iter().flat_map(|u| u.iter().map(whole).collect::<Vec<_>>()).collect(), scale)
}

impl QuadraticForm {
    /// Adds u2 to the displacement of each node for one movement of each segment, and tells the orders beyond the first.
    pub fn apply(
        &self,
        segments: &[ResponseSegment],
        movements: &[RigidMovement],
        displacement: &mut [Vector],
    ) -> BeyondLinear {
        let moved = segments.iter().zip(movements);
        let numbers = moved.flat_map(|(segment, movement)| coefficients(movement, &segment.centre));
        let numbers: Vec<f64> = numbers.collect();
        let second = self.add(&numbers, displacement);
        BeyondLinear { second, third: self.third_order(segments, movements) }
    }

    /// Adds u2 to the displacement of each node, and tells its mean length over those that move. `numbers` are those of all segments.
    fn add(&self, numbers: &[f64], displacement: &mut [Vector]) -> f64 {
        let length = 3 * displacement.len();
        if length == 0 {
            return 0.0;
        }
        let factors = pairs(self.numbers).map(|[k, l]| numbers[k] * numbers[l]);
        let terms: Vec<(f32, &[i16])> = factors
            .zip(&self.scales)
            .map(|(factor, scale)| (factor * f64::from(*scale)) as f32)
            .zip(self.values.chunks_exact(length))
            .filter(|(factor, _)| *factor != 0.0)
            .collect();
        let least = least_moving(displacement.iter().map(Vector::norm));
        let stretch = |(place, nodes): (usize, &mut [Vector])| -> [f64; 2] {
            let mut sums = [0.0_f32; STRETCH];
            let (begin, count) = (place * STRETCH, 3 * nodes.len());
            add_terms(&terms, begin, &mut sums[..count]);
            let (mut lengths, mut moving) = (0.0, 0.0);
            for (node, sum) in nodes.iter_mut().zip(sums.chunks_exact(3)) {
                let second = Vector::new(sum[0].into(), sum[1].into(), sum[2].into());
                if node.norm() >= least {
                    (lengths, moving) = (lengths + second.norm(), moving + 1.0);
                }
                *node += second;
            }
            [lengths, moving]
        };
        let stretches = displacement.par_chunks_mut(STRETCH / 3).enumerate();
        let sums: Vec<[f64; 2]> = stretches.map(stretch).collect();
        let [lengths, moving] = sums.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        lengths / moving.max(1.0)
    }

    /// The estimate of the third order for one movement of each segment.
    pub fn third_order(&self, segments: &[ResponseSegment], movements: &[RigidMovement]) -> f64 {
        let moved = segments.iter().zip(movements);
        let numbers = moved.flat_map(|(segment, by)| rigid_numbers(by, &segment.centre));
        let numbers: Vec<f64> = numbers.collect();
        let parts = numbers.iter().zip(self.third.iter().flatten());
        let parts = parts.map(|(number, tau)| number * number * tau.powf(2.0 / 3.0));
        parts.sum::<f64>().powf(1.5) * third_together(&numbers, &self.coupling)
    }
}

/// Adds factors times a stretch of their columns.
fn add_terms(terms: &[(f32, &[i16])], begin: usize, sums: &mut [f32]) {
    let end = begin + sums.len();
    vectorised(
        #[inline(always)]
        || {
            for group in terms.chunks(TOGETHER) {
                match group {
                    [(a, p), (b, q), (c, r), (d, s)] => {
                        let [p, q, r, s] = [p, q, r, s].map(|column| &column[begin..end]);
                        for ((((sum, &p), &q), &r), &s) in
                            sums.iter_mut().zip(p).zip(q).zip(r).zip(s)
                        {
                            let first = a * f32::from(p) + b * f32::from(q);
                            let second = c * f32::from(r) + d * f32::from(s);
                            *sum += first + second;
                        }
                    }
                    rest => {
                        for (factor, column) in rest {
                            for (sum, &value) in sums.iter_mut().zip(&column[begin..end]) {
                                *sum += factor * f32::from(value);
                            }
                        }
                    }
                }
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(node: usize, pair: usize) -> Vector {
        let at = (node * 7 + pair * 13) as f64;
        Vector::new((0.3 * at).sin(), (0.7 * at).cos(), (1.1 * at).sin()) * (1.0 + pair as f64)
    }

    #[test]
    fn the_sum_in_sixteen_bits_is_the_sum_within_half_a_step_of_each_pair() {
        let (numbers, nodes) = (5, 1300);
        let mut form = QuadraticForm {
            numbers,
            values: Vec::new(),
            scales: Vec::new(),
            third: Vec::new(),
            coupling: Vec::new(),
        };
        let a = [0.7, -1.3, 0.0, 2.1, 0.4];
        let mut exact = vec![Vector::zeros(); nodes];
        let mut allowed = 1e-5;
        for (pair, [k, l]) in pairs(numbers).enumerate() {
            let column: Vec<Vector> = (0..nodes).map(|node| wave(node, pair)).collect();
            let (values, scale) = quantised(&column);
            form.values.extend(values);
            form.scales.push(scale);
            let factor = a[k] * a[l];
            exact.iter_mut().zip(&column).for_each(|(sum, u)| *sum += u * factor);
            allowed += 0.5 * factor.abs() * f64::from(scale);
        }
        let mut found = vec![Vector::x(); nodes];
        let mean = form.add(&a, &mut found);
        for (found, exact) in found.iter().zip(&exact) {
            assert!((found - Vector::x() - exact).amax() < allowed, "{found} {exact}");
        }
        let expected = exact.iter().map(Vector::norm).sum::<f64>() / nodes as f64;
        assert!((mean - expected).abs() < allowed);
    }

    #[test]
    fn the_second_order_is_the_mean_over_what_the_first_moves() {
        let values = vec![100, 0, 0, 300, 0, 0, 900, 0, 0, 0, 0, 0];
        let form = QuadraticForm {
            numbers: 1,
            values,
            scales: vec![0.01],
            third: Vec::new(),
            coupling: Vec::new(),
        };
        // Two nodes move, and a tenth of the farthest is the least that counts.
        let mut displacement = [2.0, 0.2, 0.19, 0.0].map(|length| Vector::y() * length);
        assert!((form.add(&[1.0], &mut displacement) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn the_third_order_grows_with_the_cube_of_a_sampled_direction() {
        let segments = [ResponseSegment { name: "jaw".into(), centre: Vector::x() }];
        let third = vec![[1e-3, 2e-3, 3e-3, 0.4, 0.5, 0.6]];
        let form = QuadraticForm {
            numbers: 12,
            values: Vec::new(),
            scales: Vec::new(),
            third,
            coupling: Vec::new(),
        };
        let of = |angles: Vector, by: Vector| {
            form.third_order(&segments, &[RigidMovement::about_pivot(angles, Vector::x(), by)])
        };
        assert!((of(Vector::zeros(), Vector::y() * 4.0) - 64.0 * 2e-3).abs() < 1e-12);
        assert!((of(Vector::z() * 0.2, Vector::zeros()) - 0.008 * 0.6).abs() < 1e-12);
        let both = of(Vector::zeros(), Vector::new(3.0, 4.0, 0.0));
        assert!(both > 27e-3 + 64.0 * 2e-3 && both < 125.0 * 2e-3, "{both}");
    }
}
