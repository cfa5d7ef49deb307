//! Voxels that are in or out, on a grid whose axes stand at right angles.

use rayon::prelude::*;

use super::volume::{ImageVolume, Voxels};

/// The voxels of an image and how far they are apart. A sheared image is taken for an upright one with the same spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    pub size: [usize; 3],
    /// In mm.
    pub spacing: [f64; 3],
}

impl Grid {
    pub fn of(image: &ImageVolume) -> Grid {
        Grid { size: image.size(), spacing: image.spacing() }
    }

    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of a voxel, the first axis fastest.
    pub fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    pub fn index(&self, number: usize) -> [usize; 3] {
        let row = number / self.size[0];
        [number % self.size[0], row % self.size[1], row / self.size[1]]
    }

    /// Volume of one voxel, in mm³.
    pub fn voxel_volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Whether a voxel is the first or the last along an axis that has more than one.
    pub fn is_border(&self, index: [usize; 3]) -> bool {
        (0..3).any(|axis| {
            self.size[axis] > 1 && (index[axis] == 0 || index[axis] + 1 == self.size[axis])
        })
    }

    /// How far a voxel and the next one are apart in their numbers, along an axis.
    pub fn stride(&self, axis: usize) -> usize {
        self.size[..axis].iter().product()
    }

    /// The voxels that share a face with one.
    pub fn neighbours(&self, number: usize) -> impl Iterator<Item = usize> + use<> {
        let (index, grid) = (self.index(number), *self);
        (0..6).filter_map(move |side| {
            let (axis, stride) = (side / 2, grid.stride(side / 2));
            match side % 2 {
                0 => (index[axis] > 0).then(|| number - stride),
                _ => (index[axis] + 1 < grid.size[axis]).then(|| number + stride),
            }
        })
    }
}

/// A part of the voxels of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    pub grid: Grid,
    pub inside: Vec<bool>,
}

impl Mask {
    /// The voxels whose value a rule takes.
    pub fn of(image: &ImageVolume, takes: impl Fn(f64) -> bool + Sync) -> Mask {
        let inside = match image.voxels() {
            Voxels::I16(values) => {
                values.par_iter().map(|&value| takes(f64::from(value))).collect()
            }
            Voxels::F32(values) => {
                values.par_iter().map(|&value| takes(f64::from(value))).collect()
            }
        };
        Mask { grid: Grid::of(image), inside }
    }

    /// The voxels of at least that value.
    pub fn above(image: &ImageVolume, threshold: f64) -> Mask {
        Mask::of(image, |value| value >= threshold)
    }

    pub fn count(&self) -> usize {
        self.inside.par_iter().filter(|inside| **inside).count()
    }

    /// In mm³.
    pub fn volume(&self) -> f64 {
        self.count() as f64 * self.grid.voxel_volume()
    }

    pub fn complement(&self) -> Mask {
        Mask { grid: self.grid, inside: self.inside.par_iter().map(|inside| !inside).collect() }
    }

    pub fn and(&self, other: &Mask) -> Mask {
        self.with(other, |one, other| one && other)
    }

    pub fn or(&self, other: &Mask) -> Mask {
        self.with(other, |one, other| one || other)
    }

    pub fn without(&self, other: &Mask) -> Mask {
        self.with(other, |one, other| one && !other)
    }

    fn with(&self, other: &Mask, rule: impl Fn(bool, bool) -> bool + Sync) -> Mask {
        let both = self.inside.par_iter().zip(&other.inside);
        Mask { grid: self.grid, inside: both.map(|(&one, &other)| rule(one, other)).collect() }
    }
}
