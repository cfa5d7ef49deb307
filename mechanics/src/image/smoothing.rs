//! Gaussian smoothing of voxels, one axis after the other.
//!
//! The weights of a row are exp(-d²/2σ²), cut at 4 σ and scaled to sum one; beyond the border the image is mirrored about
//! its outermost voxel centres, so that a constant stays what it is.

use super::lines::{Size, for_each_line};

/// Where the Gaussian is cut, in standard deviations: 6e-5 of it lies beyond.
const REACH: f64 = 4.0;

/// Smooths in place. `deviation` is the standard deviation along each axis in voxels; zero, negative or not finite leaves an
/// axis as it is.
pub(crate) fn gaussian(values: &mut [f32], size: Size, deviation: [f64; 3]) {
    for axis in 0..3 {
        if let Some(half) = half_kernel(deviation[axis], size[axis]) {
            for_each_line(values, size, axis, |line| convolve(line, &half));
        }
    }
}

/// The middle weight and those on one side of it; `None` where there is nothing to smooth.
fn half_kernel(deviation: f64, size: usize) -> Option<Vec<f64>> {
    if !deviation.is_finite() || deviation <= 0.0 {
        return None;
    }
    let reach = ((REACH * deviation).ceil() as usize).min(size);
    let weight = |step: usize| (-0.5 * (step as f64 / deviation).powi(2)).exp();
    let half: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = 2.0 * half.iter().sum::<f64>() - half[0];
    Some(half.into_iter().map(|weight| weight / sum).collect())
}

fn convolve(line: &mut [f32], half: &[f64]) {
    let source: Vec<f64> = line.iter().map(|&value| f64::from(value)).collect();
    let size = source.len() as isize;
    let at = |place: isize| source[mirrored(place, size)];
    for (place, value) in line.iter_mut().enumerate() {
        let place = place as isize;
        let sides = half.iter().enumerate().skip(1);
        let sum = sides.fold(half[0] * source[place as usize], |sum, (step, weight)| {
            sum + weight * (at(place - step as isize) + at(place + step as isize))
        });
        *value = sum as f32;
    }
}

/// A place beyond the border, mirrored about the first or last voxel as often as needed.
fn mirrored(place: isize, size: isize) -> usize {
    let period = (2 * (size - 1)).max(1);
    let inside = place.rem_euclid(period);
    inside.min(period - inside).min(size - 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_stays_and_a_peak_spreads_to_its_variance() {
        let size = [33, 9, 2];
        let mut constant = vec![7.5f32; 33 * 9 * 2];
        gaussian(&mut constant, size, [2.0, 1.0, 3.0]);
        assert!(constant.iter().all(|value| (value - 7.5).abs() < 1e-5));

        let mut peak = vec![0.0f32; 33];
        peak[16] = 1.0;
        gaussian(&mut peak, [33, 1, 1], [2.0, 0.0, f64::NAN]);
        let variance: f64 =
            peak.iter().enumerate().map(|(x, &w)| f64::from(w) * (x as f64 - 16.0).powi(2)).sum();
        // Cut at four deviations, a Gaussian loses 1.1e-3 of its variance.
        assert!((variance - 4.0).abs() < 6e-3, "{variance}");
    }

    #[test]
    fn places_beyond_the_border_are_mirrored() {
        let found: Vec<usize> = (-4..8).map(|place| mirrored(place, 3)).collect();
        assert_eq!(found, [0, 1, 2, 1, 0, 1, 2, 1, 0, 1, 2, 1]);
        assert!((-3..4).all(|place| mirrored(place, 1) == 0));
    }
}
