//! Sizing field of a mesh: fine cells around the bone that moves.

use crate::mesh::{Vector, VolumeMesh, Warning, bounds_of};
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

/// Places of which the tissue is to be fine, and from which its nearest node is farther than an edge of the finest cells, in mm.
pub(super) fn without_tissue(
    regions: &[SizeRegion],
    volume: &VolumeMesh,
    finest: f64,
) -> Vec<Warning> {
    let warning = |(number, region): (usize, &SizeRegion)| {
        let distances = volume.nodes.iter().map(|node| region.shape.distance(node));
        let nearest = distances.fold(f64::INFINITY, f64::min);
        let [x, y, z]: [f64; 3] = region.shape.middle().into();
        let detail = format!(
            "place {number} of `size.fine`, around ({x:.0}, {y:.0}, {z:.0}) mm, holds no tissue, which is {nearest:.1} mm away at its nearest: \
             nothing was made finer there; is it in the frame of the document?"
        );
        let warning = Warning::new("fine-place-empty", detail).with("place", number as f64);
        (nearest > finest).then(|| warning.with("distance_mm", nearest))
    };
    regions.iter().enumerate().filter_map(warning).collect()
}

fn box_of(bone: &Labelled, segment: usize) -> Option<(Vector, Vector)> {
    let voxels: usize = bone.labels.size().iter().product();
    let own = (0..voxels)
        .filter(|&voxel| bone.labels.owner(voxel) == Some(Owner::Segment(segment)))
        .map(|voxel| bone.labels.centre_of(voxel));
    bounds_of(own).map(Into::into)
}
