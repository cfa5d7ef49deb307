//! Rows of teeth: the voxels of segments as bright as enamel, and what lies near them.

use super::bone_image::BoneImage;
use super::bone_labels::{BoneLabels, Owner};
use super::grid::Grid;
use crate::mesh::Vector;
use crate::mesh::cubes::Cubes;

/// Enamel in Hounsfield units. Dense bone of a jaw reaches 1700 on the CT of `examples/head_ct`.
pub const ENAMEL_HU: f64 = 1800.0;

/// Mucosa lies this near to the middle of a voxel of enamel, in mm: half a voxel of a coarse scan, and the width of attached
/// gingiva, 1 to 9 mm.
pub const MUCOSA_MM: f64 = 4.0;

/// Voxels of teeth, and how far around them tissue is mucosa.
#[derive(Clone, Debug, PartialEq)]
pub struct Teeth {
    centres: Vec<Vector>,
    reach_mm: f64,
    cubes: Cubes,
}

impl Teeth {
    /// Voxels of segments above a value; bone of the skull that is as dense, beside the ear, is no tooth. The reach is
    /// positive.
    pub fn new(bone: &BoneImage<'_>, labels: &BoneLabels, enamel: f64, reach_mm: f64) -> Teeth {
        let grid = Grid::new(bone.image);
        let is_tooth = |voxel: &usize| {
            let is_of_segment = match labels.owner(*voxel) {
                Some(Owner::Segment(_)) => true,
                Some(Owner::Rest | Owner::Sawn | Owner::Loose) | None => false,
            };
            is_of_segment && bone.value(*voxel) > enamel
        };
        let centres: Vec<Vector> =
            (0..grid.len()).filter(is_tooth).map(|voxel| grid.centre(voxel)).collect();
        let numbered = (0..).zip(centres.iter().copied());
        let cubes = Cubes::new(reach_mm, numbered);
        Teeth { centres, reach_mm, cubes }
    }

    /// How many voxels are teeth.
    pub fn voxels(&self) -> usize {
        self.centres.len()
    }

    /// Whether a tooth is within reach of a place.
    pub fn near(&self, place: &Vector) -> bool {
        let distance = |tooth: u32| (self.centres[tooth as usize] - place).norm();
        self.cubes.around(place).any(|tooth| distance(tooth) <= self.reach_mm)
    }
}
