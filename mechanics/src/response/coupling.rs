//! How the sampled directions of all segments act together in the second and the third order.
//!
//! z = A^-1 w are solved for some probes w on the skin, so that w . u2 = -z . N2(u1, u1) follows for every pair of directions
//! without a solve, and w . u3 for every three of them. Probe w has a random sign for each axis of each patch of the skin that
//! moves, over the root of the number of its nodes: the mean of (w . u)^2 over probes is about the sum of |u|^2 over the nodes
//! (Johnson and Lindenstrauss; 24 probes leave a deviation of a seventh of the length). The length of a plan is then that
//! of its directions one by one, as they were sampled, times what the probes say of all together against the same of one by one.

use super::rigid_numbers::SAMPLES;

/// Probes of the skin.
pub const PROBES: usize = 24;

/// What the probes say of a product of directions: w . U.
pub type Probed = [f32; PROBES];

/// The pairs of so many numbers in their order.
pub fn pairs(numbers: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..numbers).flat_map(move |k| (k..numbers).map(move |l| [k, l]))
}

/// Triples of so many numbers in their order: (0,0,0), (0,0,1), ..., (0,1,1), ...
pub(super) fn triples(numbers: usize) -> impl Iterator<Item = [usize; 3]> {
    pairs(numbers).flat_map(move |[j, k]| (k..numbers).map(move |l| [j, k, l]))
}

/// Whether a coupling has a probe of each product of so many directions.
pub fn couples(order: usize, segments: usize, probed: usize) -> bool {
    let n = SAMPLES * segments;
    let products = if order == 2 { n * (n + 1) / 2 } else { n * (n + 1) * (n + 2) / 6 };
    probed == 0 || probed == products
}

/// The second order of numbers together over that of each alone.
pub(super) fn second_together(numbers: &[f64], second: &[Probed]) -> f64 {
    let products = pairs(numbers.len()).zip(second);
    let mut alone = 0.0;
    let mut sum = [0.0; PROBES];
    for ([k, l], probed) in products {
        let factor = numbers[k] * numbers[l];
        add(&mut sum, probed, factor);
        if k == l {
            alone += factor * length(&probed.map(f64::from));
        }
    }
    ratio(length(&sum), alone)
}

/// The third order of numbers together over that of each alone, put together as if it were the same in every direction.
pub(super) fn third_together(numbers: &[f64], third: &[Probed]) -> f64 {
    let mut alone = 0.0;
    let mut sum = [0.0; PROBES];
    for ([j, k, l], probed) in triples(numbers.len()).zip(third) {
        add(&mut sum, probed, numbers[j] * numbers[k] * numbers[l]);
        if j == l {
            alone += numbers[j] * numbers[j] * length(&probed.map(f64::from)).powf(2.0 / 3.0);
        }
    }
    ratio(length(&sum), alone.powf(1.5))
}

fn ratio(together: f64, alone: f64) -> f64 {
    if alone > 0.0 { together / alone } else { 1.0 }
}

fn length(probed: &[f64; PROBES]) -> f64 {
    probed.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn add(sum: &mut [f64; PROBES], probed: &Probed, factor: f64) {
    sum.iter_mut().zip(probed).for_each(|(sum, value)| *sum += factor * f64::from(*value));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_directions_together_have_their_cross_term() {
        let of = |value: f32| [value; PROBES];
        // (0,0), (0,1), (1,1): squares of 1 and 1, and a cross term of 3.
        let second = [of(1.0), of(3.0), of(1.0)];
        assert!((second_together(&[2.0, 0.0], &second) - 1.0).abs() < 1e-12);
        assert!((second_together(&[1.0, 1.0], &second) - 2.5).abs() < 1e-12);
        assert!((second_together(&[1.0, -1.0], &second) - 0.5).abs() < 1e-12);
        // (0,0,0), (0,0,1), (0,1,1), (1,1,1).
        let third = [of(8.0), of(0.0), of(0.0), of(8.0)];
        assert!((third_together(&[0.0, 2.0], &third) - 1.0).abs() < 1e-12);
        assert!((third_together(&[1.0, 1.0], &third) - 16.0 / 8.0 / 8_f64.sqrt()).abs() < 1e-12);
        assert_eq!(second_together(&[0.0, 0.0], &second), 1.0);
        assert!(couples(2, 1, 21) && couples(3, 1, 56) && !couples(2, 2, 77) && couples(3, 2, 364));
    }
}
