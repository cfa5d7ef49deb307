//! Operations on the voxels of a scan, held against closed forms and against doing it by hand.

mod head;
mod masks;
mod report;
mod tissues;

use mechanics::image::{Grid, ImageVolume, Mask, Placement, Voxels};
use mechanics::mesh::Vector;

/// A generator of Marsaglia (2003), so that every run is the same.
pub struct Random(pub u64);

impl Random {
    /// From 0 to below 1.
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

pub fn random_mask(size: [usize; 3], spacing: [f64; 3], share: f64, seed: u64) -> Mask {
    let mut random = Random(seed);
    let grid = Grid { size, spacing };
    Mask { grid, inside: (0..grid.len()).map(|_| random.next() < share).collect() }
}

/// Where a voxel of a grid stands, in mm from the first.
pub fn place(grid: &Grid, voxel: usize) -> Vector {
    let index = grid.index(voxel);
    Vector::from([0, 1, 2].map(|axis| index[axis] as f64 * grid.spacing[axis]))
}

/// The voxels whose place a rule takes.
pub fn mask(size: [usize; 3], spacing: [f64; 3], takes: impl Fn(Vector) -> bool) -> Mask {
    let grid = Grid { size, spacing };
    Mask { grid, inside: (0..grid.len()).map(|voxel| takes(place(&grid, voxel))).collect() }
}

/// An image with a value at each place; x to the left, y to the back, z upwards.
pub fn image(size: [usize; 3], spacing: [f64; 3], value: impl Fn(Vector) -> f64) -> ImageVolume {
    let grid = Grid { size, spacing };
    let values = (0..grid.len()).map(|voxel| value(place(&grid, voxel)) as f32).collect();
    let steps = [Vector::x() * spacing[0], Vector::y() * spacing[1], Vector::z() * spacing[2]];
    ImageVolume::new(size, Placement { origin: Vector::zeros(), steps }, Voxels::F32(values))
        .unwrap()
}
