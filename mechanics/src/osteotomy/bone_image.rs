//! The bone of a scan: what is brighter than a threshold.

use crate::image::{ImageVolume, Voxels};

/// The bone of a scan: voxels whose value is above a threshold.
#[derive(Clone, Copy)]
pub struct BoneImage<'a> {
    pub image: &'a ImageVolume,
    /// In the unit of the image; for a CT in Hounsfield units.
    pub threshold: f64,
}

impl BoneImage<'_> {
    /// The value of a voxel, by its number with the first axis fastest.
    pub fn value(&self, voxel: usize) -> f64 {
        match self.image.voxels() {
            Voxels::I16(values) => f64::from(values[voxel]),
            Voxels::F32(values) => f64::from(values[voxel]),
        }
    }
}
