//! Sizing field of a mesh: fine cells around the bone that moves.

use crate::mesh::Vector;
use crate::meshing::{RegionShape, SizeRegion};
use crate::osteotomy::Owner;
use crate::osteotomy::labelling::Labelled;

/// Tissue this far from the box of a segment is as fine as at the segment, in mm.
const AROUND: f64 = 10.0;

/// A box around each segment in which cells are `finest`.
pub(super) fn around_segments(bone: &Labelled, finest: f64) -> Vec<SizeRegion> {
    let boxes = (0..bone.segments.len()).filter_map(|segment| box_of(bone, segment));
    let regions = boxes.map(|(low, high)| SizeRegion {
        shape: RegionShape::Box { low: low.add_scalar(-AROUND), high: high.add_scalar(AROUND) },
        size: finest,
    });
    regions.collect()
}

fn box_of(bone: &Labelled, segment: usize) -> Option<(Vector, Vector)> {
    let voxels: usize = bone.labels.size().iter().product();
    let own = (0..voxels)
        .filter(|&voxel| bone.labels.owner(voxel) == Some(Owner::Segment(segment)))
        .map(|voxel| bone.labels.centre_of(voxel));
    own.map(|x| (x, x)).reduce(|(low, high), (a, b)| (low.inf(&a), high.sup(&b)))
}
