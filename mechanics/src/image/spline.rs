//! A cubic B-spline through the voxels of an image: smooth values and exact gradients between voxel centres.
//!
//! s(x) = Σ c_k β³(x - k) with coefficients such that s is the voxel's value at every voxel centre, found by one causal and
//! one anticausal recursion with the pole z = √3 - 2 along each axis. Beyond the border the image is mirrored about its
//! outermost voxel centres.
//! Source: Unser, Splines: a perfect fit for signal and image processing, IEEE Signal Processing Magazine 16 (1999) 22-38,
//! box 2.
//!
//! Several images of one grid, the channels, share places and weights. Coefficients are f32 (rounding 6e-8 of the largest
//! value), sums f64, so that the spline is smooth to f64.

use rayon::prelude::*;

use super::lines::{Size, for_each_line};
use crate::vectorised::vectorised;

/// √3 - 2.
const POLE: f64 = -0.267_949_192_431_122_7;
/// |z|^30 is 7e-18.
const HORIZON: usize = 30;

/// Values and gradients at one place, per voxel step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineValue {
    pub value: f64,
    /// By the index along each axis.
    pub gradient: [f64; 3],
}

/// The spline of `N` channels.
#[derive(Clone, Debug)]
pub struct CubicSpline<const N: usize> {
    size: Size,
    /// With one layer more on each side than the image has, the mirror of the second.
    coefficients: Vec<[f32; N]>,
}

impl<const N: usize> CubicSpline<N> {
    /// Through the values of each channel, as many as `size` says; two or more voxels along each axis.
    pub fn new(size: [usize; 3], channels: [Vec<f32>; N]) -> Self {
        let channels = channels.map(|mut values| {
            for axis in 0..3 {
                for_each_line(&mut values, size, axis, prefilter);
            }
            values
        });
        CubicSpline { size, coefficients: padded(size, &channels) }
    }

    /// With the values as coefficients: the values of each channel blurred by β³, as wide as a Gaussian of .58 voxels.
    pub fn blurred(size: [usize; 3], channels: &[Vec<f32>; N]) -> Self {
        CubicSpline { size, coefficients: padded(size, channels) }
    }

    /// Voxels along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Coefficients along each axis: two more than voxels; coefficient 1 stands at voxel 0.
    pub(crate) fn padded_size(&self) -> Size {
        self.size.map(|size| size + 2)
    }

    pub(crate) fn coefficients(&self) -> &[[f32; N]] {
        &self.coefficients
    }

    /// The value of each channel at a place in voxels; beyond the border that of the nearest place on it.
    pub fn at(&self, place: [f64; 3]) -> [f64; N] {
        let support = self.support(place);
        let [x, y, z] = support.map(|axis| axis.weights());
        let [rows] = self.sums(&support, |j, k| [y[j] * z[k]]);
        along(&x, &rows)
    }

    /// Value and gradient of each channel at a place in voxels.
    pub fn with_gradient(&self, place: [f64; 3]) -> [SplineValue; N] {
        let support = self.support(place);
        let [x, y, z] = support.map(|axis| axis.weights());
        let [dx, dy, dz] = support.map(|axis| axis.slopes());
        let rows = self.sums(&support, |j, k| [y[j] * z[k], dy[j] * z[k], y[j] * dz[k]]);
        let [value, by_y, by_z] = rows.map(|rows| along(&x, &rows));
        let by_x = along(&dx, &rows[0]);
        std::array::from_fn(|n| SplineValue {
            value: value[n],
            gradient: [by_x[n], by_y[n], by_z[n]],
        })
    }

    fn support(&self, place: [f64; 3]) -> [Support; 3] {
        std::array::from_fn(|axis| Support::new(place[axis], self.size[axis]))
    }

    /// The four coefficients along the first axis, summed over the sixteen rows around a place with each of `M` weights by their
    /// numbers along the second and third axis.
    fn sums<const M: usize>(
        &self,
        support: &[Support; 3],
        weights: impl Fn(usize, usize) -> [f64; M],
    ) -> [[[f64; N]; 4]; M] {
        let [nx, ny, _] = self.padded_size();
        let [x, y, z] = support.map(|axis| axis.first);
        let weights: [[f64; M]; 16] = std::array::from_fn(|row| weights(row % 4, row / 4));
        let mut found = [[[0.0; N]; 4]; M];
        vectorised(
            #[inline(always)]
            || {
                let mut sums = [[[0.0; N]; 4]; M];
                for (row, weights) in weights.iter().enumerate() {
                    let start = ((z + row / 4) * ny + y + row % 4) * nx + x;
                    let Some(row) = self.coefficients[start..].first_chunk::<4>() else { continue };
                    for (sums, weight) in sums.iter_mut().zip(weights) {
                        for (sum, values) in
                            sums.as_flattened_mut().iter_mut().zip(row.as_flattened())
                        {
                            *sum += weight * f64::from(*values);
                        }
                    }
                }
                found = sums;
            },
        );
        found
    }
}

/// A voxel that a place sees.
#[derive(Clone, Copy, Debug)]
pub struct VoxelWeight {
    pub voxel: usize,
    pub weight: f64,
    /// How the weight changes by the index along each axis.
    pub slope: [f64; 3],
}

/// The voxels that a spline value depends on, with their weights, whose sum is one; those beyond the border are
/// mirrored.
pub fn spline_weights(size: [usize; 3], place: [f64; 3], mut each: impl FnMut(VoxelWeight)) {
    let support: [Support; 3] = std::array::from_fn(|axis| Support::new(place[axis], size[axis]));
    let [x, y, z] = support.map(Support::weights);
    let [dx, dy, dz] = support.map(Support::slopes);
    let index = |axis: usize, n: usize| unpadded(support[axis].first + n, size[axis]);
    for k in 0..4 {
        for j in 0..4 {
            let row = (index(2, k) * size[1] + index(1, j)) * size[0];
            for i in 0..4 {
                let slope = [dx[i] * y[j] * z[k], x[i] * dy[j] * z[k], x[i] * y[j] * dz[k]];
                let weight = x[i] * y[j] * z[k];
                each(VoxelWeight { voxel: row + index(0, i), weight, slope });
            }
        }
    }
}

/// The voxel at a place of the padded array: beyond the border the mirror of the second.
fn unpadded(place: usize, size: usize) -> usize {
    match place {
        0 => 1,
        _ if place == size + 1 => size - 2,
        _ => place - 1,
    }
}

fn along<const N: usize>(weights: &[f64; 4], rows: &[[f64; N]; 4]) -> [f64; N] {
    std::array::from_fn(|number| (0..4).map(|i| weights[i] * rows[i][number]).sum())
}

/// Which four coefficients along an axis a place sees, and where it lies between the middle two.
#[derive(Clone, Copy)]
struct Support {
    /// In the padded array.
    first: usize,
    part: f64,
}

impl Support {
    fn new(place: f64, size: usize) -> Self {
        // A place that is no number is taken to the first voxel.
        let inside = place.max(0.0).min((size - 1) as f64);
        let first = (inside as usize).min(size - 2);
        Support { first, part: inside - first as f64 }
    }

    /// β³ at the four coefficients.
    fn weights(self) -> [f64; 4] {
        let (t, u) = (self.part, 1.0 - self.part);
        let inner = |near: f64| 2.0 / 3.0 - near * near * (1.0 - 0.5 * near);
        [u * u * u / 6.0, inner(t), inner(u), t * t * t / 6.0]
    }

    /// The derivatives of the weights.
    fn slopes(self) -> [f64; 4] {
        let (t, u) = (self.part, 1.0 - self.part);
        let inner = |near: f64| near * (1.5 * near - 2.0);
        [-0.5 * u * u, inner(t), -inner(u), 0.5 * t * t]
    }
}

/// Values of one row to coefficients of one row.
fn prefilter(line: &mut [f32]) {
    let gain = (1.0 - POLE) * (1.0 - 1.0 / POLE);
    let mut c: Vec<f64> = line.iter().map(|&value| f64::from(value) * gain).collect();
    let last = c.len() - 1;
    c[0] = causal_start(&c);
    for k in 1..=last {
        c[k] += POLE * c[k - 1];
    }
    c[last] = POLE / (POLE * POLE - 1.0) * (c[last] + POLE * c[last - 1]);
    for k in (0..last).rev() {
        c[k] = POLE * (c[k + 1] - c[k]);
    }
    line.iter_mut().zip(c).for_each(|(value, coefficient)| *value = coefficient as f32);
}

/// Σ z^k s_k over the mirrored row; exact for short rows, to rounding for long ones.
fn causal_start(scaled: &[f64]) -> f64 {
    let last = scaled.len() - 1;
    if last >= HORIZON {
        return scaled[..HORIZON].iter().rev().fold(0.0, |sum, value| value + POLE * sum);
    }
    let power = |k: usize| POLE.powi(k as i32);
    let inner = (1..last).map(|k| (power(k) + power(2 * last - k)) * scaled[k]);
    let ends = scaled[0] + power(last) * scaled[last];
    (ends + inner.sum::<f64>()) / (1.0 - power(2 * last))
}

/// Channels side by side, with a layer more on each side.
fn padded<const N: usize>(size: Size, channels: &[Vec<f32>; N]) -> Vec<[f32; N]> {
    let [px, py, pz] = size.map(|size| size + 2);
    let mut all = vec![[0.0; N]; px * py * pz];
    all.par_chunks_mut(px * py).enumerate().for_each(|(z, slice)| {
        let z = unpadded(z, size[2]);
        for (y, row) in slice.chunks_mut(px).enumerate() {
            let start = (z * size[1] + unpadded(y, size[1])) * size[0];
            for (x, coefficient) in row.iter_mut().enumerate() {
                let from = start + unpadded(x, size[0]);
                *coefficient = std::array::from_fn(|channel| channels[channel][from]);
            }
        }
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = [7, 40, 2];

    fn voxels(at: impl Fn(f64, f64, f64) -> f64) -> Vec<f32> {
        let [nx, ny, nz] = SIZE;
        let count = 0..nx * ny * nz;
        count
            .map(|n| at((n % nx) as f64, (n / nx % ny) as f64, (n / nx / ny) as f64) as f32)
            .collect()
    }

    /// Places all over the image, border included.
    fn places() -> impl Iterator<Item = [f64; 3]> {
        let part = |n: usize, step: f64| (n as f64 * step).fract();
        (0..200)
            .map(move |n| [part(n, 0.618_034) * 6.0, part(n, 0.754_878) * 39.0, part(n, 0.569_84)])
    }

    fn wavy(x: f64, y: f64, z: f64) -> f64 {
        (0.9 * x).sin() * (0.4 * y).cos() * 100.0 + 30.0 * z * y
    }

    #[test]
    fn the_spline_goes_through_every_voxel() {
        let spline = CubicSpline::new(SIZE, [voxels(wavy), voxels(|x, y, z| x + y * z)]);
        for n in 0..7 * 40 * 2 {
            let [x, y, z] = [n % 7, n / 7 % 40, n / 280].map(|index| index as f64);
            let [one, other] = spline.at([x, y, z]);
            // Voxels and coefficients are rounded to f32: 1e-7 of 1200.
            assert!((one - wavy(x, y, z)).abs() < 1e-3, "{x} {y} {z}: {one}");
            assert!((other - (x + y * z)).abs() < 1e-4);
        }
    }

    #[test]
    fn a_cubic_is_its_own_spline_away_from_the_mirrored_border() {
        let cubic = |y: f64| 0.01 * y * y * y - 0.3 * y * y + y;
        let spline = CubicSpline::new(SIZE, [voxels(|_, y, _| cubic(y))]);
        // The border is felt as 0.27 to the power of the distance.
        for y in [15.0, 17.3, 19.5, 21.99] {
            let found = spline.with_gradient([3.2, y, 0.4])[0];
            assert!((found.value - cubic(y)).abs() < 1e-4, "{y}: {found:?}");
            let slope = 0.03 * y * y - 0.6 * y + 1.0;
            assert!((found.gradient[1] - slope).abs() < 1e-4, "{y}: {found:?}");
            assert!(found.gradient[0].abs() < 1e-4 && found.gradient[2].abs() < 1e-4);
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_value() {
        let spline = CubicSpline::new(SIZE, [voxels(|x, _, _| x), voxels(wavy)]);
        for place in places() {
            let found = spline.with_gradient(place)[1];
            assert_eq!(found.value.to_bits(), spline.at(place)[1].to_bits());
            for axis in 0..3 {
                let step = 1e-5;
                let shifted = |by: f64| {
                    let mut shifted = place;
                    shifted[axis] += by;
                    spline.at(shifted)[1]
                };
                let limit = (SIZE[axis] - 1) as f64;
                if place[axis] < step || place[axis] > limit - step {
                    continue;
                }
                let difference = (shifted(step) - shifted(-step)) / (2.0 * step);
                // Second order in the step, and rounding of 1e3 over the step.
                assert!((difference - found.gradient[axis]).abs() < 1e-6, "{place:?} {axis}");
            }
        }
    }

    #[test]
    fn places_outside_and_places_that_are_no_number_have_values() {
        let spline = CubicSpline::new(SIZE, [voxels(wavy)]);
        assert_eq!(spline.at([-5.0, 3.0, 0.0]), spline.at([0.0, 3.0, 0.0]));
        assert_eq!(spline.at([9.0, 3.0, 1e300]), spline.at([6.0, 3.0, 1.0]));
        assert!(spline.at([f64::NAN, f64::INFINITY, f64::NEG_INFINITY])[0].is_finite());
    }
}
