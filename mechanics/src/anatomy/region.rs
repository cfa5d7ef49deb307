//! Region of interest: the tissue around the segments of an operation.

use std::collections::BTreeMap;

use crate::domain::{Ball, Limit};
use crate::mesh::Vector;
use crate::osteotomy::Owner;
use crate::osteotomy::labelling::Labelled;

/// Voxels of segments share a ball with those in the same cube, whose edge is this share of the margin.
const SHARE: f64 = 0.5;
/// Cubes are no smaller, in mm.
const LEAST_CUBE: f64 = 10.0;

/// Balls that hold all points at most `margin` mm away from the middles of voxels of segments, and few others; `None` where
/// there is no segment.
pub fn around_segments(bone: &Labelled, margin: f64) -> Option<Limit> {
    let width = (margin * SHARE).max(LEAST_CUBE);
    let mut cubes: BTreeMap<[i64; 3], (Vector, Vector)> = BTreeMap::new();
    let voxels: usize = bone.labels.size().iter().product();
    let of_segments =
        (0..voxels).filter(|&voxel| matches!(bone.labels.owner(voxel), Some(Owner::Segment(_))));
    for middle in of_segments.map(|voxel| bone.labels.centre_of(voxel)) {
        let cube = [0, 1, 2].map(|axis| (middle[axis] / width).floor() as i64);
        let (low, high) = cubes.entry(cube).or_insert((middle, middle));
        (*low, *high) = (low.inf(&middle), high.sup(&middle));
    }
    let ball = |(low, high): (Vector, Vector)| Ball {
        centre: (low + high) / 2.0,
        radius: margin + (high - low).norm() / 2.0,
    };
    let balls: Vec<Ball> = cubes.into_values().map(ball).collect();
    (!balls.is_empty()).then_some(Limit::Balls(balls))
}
