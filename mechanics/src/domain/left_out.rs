//! Tissue and bone of a scan that are disconnected from the body: a second body, a table, noise.

use super::compartments::Compartment;
use super::flood::{largest_piece, piece_sizes, place};
use crate::image::ImageVolume;
use crate::mesh::Vector;

const MM3_IN_ML: f64 = 1000.0;
/// A body that is less than this share of all tissue and bone is none.
const LEAST_KEPT: f64 = 1.0 / 3.0;

/// Parts that are disconnected from the body and so count as air. Volumes in ml, with bone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    pub pieces: usize,
    pub all: f64,
    /// Of the largest piece.
    pub largest: f64,
    /// The centre of the largest piece, in mm.
    pub centre: Vector,
    /// What is kept.
    pub kept: f64,
}

impl LeftOut {
    /// Whether the body is a small part of all tissue and bone.
    pub(super) fn is_most(&self) -> bool {
        self.kept < LEAST_KEPT * (self.kept + self.all)
    }
}

/// The parts that a division leaves out.
pub(super) fn left_out(
    image: &ImageVolume,
    all: &[Compartment],
    has_body: impl Fn(usize) -> bool,
) -> LeftOut {
    let is_out = |voxel: usize| all[voxel] == Compartment::OuterAir && has_body(voxel);
    let is_kept = |voxel: usize| all[voxel] != Compartment::OuterAir && has_body(voxel);
    let sizes = piece_sizes(image.size(), is_out);
    let ml = |voxels: usize| voxels as f64 * image.voxel_volume() / MM3_IN_ML;
    let kept = ml((0..all.len()).filter(|&voxel| is_kept(voxel)).count());
    let found =
        LeftOut { pieces: sizes.len(), all: ml(sizes.iter().sum()), kept, ..LeftOut::default() };
    let Some(&largest) = sizes.iter().max() else { return found };
    let piece = largest_piece(image.size(), is_out);
    let voxels = (0..all.len()).filter(|&voxel| piece[voxel]);
    let sum: Vector = voxels.map(|voxel| image.centre(place(voxel, image.size()))).sum();
    LeftOut { largest: ml(largest), centre: sum / largest as f64, ..found }
}
