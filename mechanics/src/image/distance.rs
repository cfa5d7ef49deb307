//! Distance from every voxel to the nearest of some voxels, and which one that is.
//!
//! The exact Euclidean distance between voxel centres of a grid with right angles, in mm: the lower envelope of parabolas
//! along one axis after the other.
//! Source: Felzenszwalb, Huttenlocher, Distance transforms of sampled functions, Theory of Computing 8 (2012) 415-428,
//! section 2.1.

use rayon::prelude::*;

use super::lines::{Size, for_each_line};
use super::mask::Mask;

/// The nearest of the marked voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Square of the distance in mm²; infinite where no voxel is marked.
    pub square: f32,
    /// The number of the marked voxel.
    pub voxel: u32,
}

impl Default for Nearest {
    fn default() -> Self {
        Nearest { square: f32::INFINITY, voxel: u32::MAX }
    }
}

impl Nearest {
    /// In mm.
    pub fn distance(&self) -> f64 {
        f64::from(self.square).sqrt()
    }
}

/// For each voxel the nearest one for which `is_marked` holds.
pub fn nearest_marked(
    size: [usize; 3],
    spacing: [f64; 3],
    is_marked: impl Fn(usize) -> bool,
) -> Vec<Nearest> {
    let start = |voxel: usize| match is_marked(voxel) {
        true => Nearest { square: 0.0, voxel: voxel as u32 },
        false => Nearest::default(),
    };
    let mut nearest: Vec<Nearest> = (0..count(size)).map(start).collect();
    for (axis, step) in spacing.into_iter().enumerate() {
        let step_square = step * step;
        for_each_line(&mut nearest, size, axis, |line| envelope(line, step_square));
    }
    nearest
}

/// The squared distance from the centre of each voxel to the nearest centre within the mask, in mm²; infinite where the
/// mask is empty.
pub fn squared_distance(mask: &Mask) -> Vec<f32> {
    let nearest = nearest_marked(mask.grid.size, mask.grid.spacing, |voxel| mask.inside[voxel]);
    nearest.into_iter().map(|nearest| nearest.square).collect()
}

/// The distance itself, in mm.
pub fn distance(mask: &Mask) -> Vec<f32> {
    let mut values = squared_distance(mask);
    values.par_iter_mut().for_each(|value| *value = value.sqrt());
    values
}

fn count(size: Size) -> usize {
    size.iter().product()
}

/// A parabola of the lower envelope: where it stands and from where on it is the lowest.
struct Parabola {
    place: f64,
    from: f64,
    nearest: Nearest,
}

fn envelope(line: &mut [Nearest], step_square: f64) {
    let mut lowest: Vec<Parabola> = Vec::with_capacity(line.len());
    for (place, &nearest) in line.iter().enumerate() {
        if nearest.square < f32::INFINITY {
            push(&mut lowest, place as f64, nearest, step_square);
        }
    }
    let mut number = 0;
    for (place, slot) in line.iter_mut().enumerate() {
        let place = place as f64;
        while lowest.get(number + 1).is_some_and(|next| next.from < place) {
            number += 1;
        }
        if let Some(Parabola { place: at, nearest, .. }) = lowest.get(number) {
            let square = f64::from(nearest.square) + step_square * (place - at) * (place - at);
            *slot = Nearest { square: square as f32, voxel: nearest.voxel };
        }
    }
}

fn push(lowest: &mut Vec<Parabola>, place: f64, nearest: Nearest, step_square: f64) {
    let height = f64::from(nearest.square) / step_square + place * place;
    while let Some(last) = lowest.last() {
        let below = f64::from(last.nearest.square) / step_square + last.place * last.place;
        let from = (height - below) / (2.0 * (place - last.place));
        if from > last.from {
            lowest.push(Parabola { place, from, nearest });
            return;
        }
        lowest.pop();
    }
    lowest.push(Parabola { place, from: f64::NEG_INFINITY, nearest });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_looking_at_every_marked_voxel() {
        let (size, spacing) = ([7, 6, 9], [3.2, 3.2, 1.5]);
        let marked = |n: usize| (n * 7919).is_multiple_of(61);
        let place = |n: usize| {
            let index = [n % 7, n / 7 % 6, n / 42];
            [0, 1, 2].map(|axis| index[axis] as f64 * spacing[axis])
        };
        let square = |a: usize, b: usize| -> f64 {
            (0..3).map(|axis| (place(a)[axis] - place(b)[axis]).powi(2)).sum()
        };
        for (n, found) in nearest_marked(size, spacing, marked).iter().enumerate() {
            let least = (0..378).filter(|&m| marked(m)).map(|m| square(n, m)).reduce(f64::min);
            assert!((f64::from(found.square) - least.unwrap()).abs() < 1e-4, "{n}: {found:?}");
            assert!((square(n, found.voxel as usize) - least.unwrap()).abs() < 1e-4);
        }
    }

    #[test]
    fn where_nothing_is_marked_everything_is_infinitely_far() {
        let found = nearest_marked([2, 3, 4], [1.0; 3], |_| false);
        assert!(found.iter().all(|nearest| nearest.distance() == f64::INFINITY));
    }
}
