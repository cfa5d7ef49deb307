//! Seeded watershed: each voxel goes to the seed from which it is reached over the brightest way.
//!
//! Voxels are taken in the order of their value, the brightest first, each for the segment that reached it first; what
//! is taken is a wall to others. Bones that touch are parted where their contact is dimmest, which partial volume makes
//! of every joint and of teeth that meet.
//! Source: Meyer, Topographic distance and watershed lines, Signal Processing 38 (1994), section 4.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::bone_labels::{BoneLabels, Owner};
use super::grid::Grid;
use super::rule::Osteotomy;

/// A voxel that a segment has reached: brighter ones first, then those that were reached earlier.
struct FrontVoxel {
    value: f64,
    turn: Reverse<u64>,
    voxel: usize,
    segment: usize,
}

impl Ord for FrontVoxel {
    fn cmp(&self, other: &Self) -> Ordering {
        self.value.total_cmp(&other.value).then(self.turn.cmp(&other.turn))
    }
}

impl PartialOrd for FrontVoxel {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for FrontVoxel {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for FrontVoxel {}

/// A voxel that a segment grows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Marker {
    pub segment: usize,
    pub voxel: usize,
}

/// Gives every voxel of bone that a segment reaches on its sides of the cuts to that segment.
pub(super) fn flood(
    osteotomy: &Osteotomy,
    grid: &Grid<'_>,
    value: impl Fn(usize) -> f64,
    markers: &[Marker],
    labels: &mut BoneLabels,
) {
    let mut waiting = BinaryHeap::new();
    let mut turn = 0;
    let mut reach = |waiting: &mut BinaryHeap<FrontVoxel>, voxel: usize, segment: usize| {
        turn += 1;
        waiting.push(FrontVoxel { value: value(voxel), turn: Reverse(turn), voxel, segment });
    };
    for marker in markers {
        reach(&mut waiting, marker.voxel, marker.segment);
    }
    while let Some(FrontVoxel { voxel, segment, .. }) = waiting.pop() {
        if labels.owner(voxel) != Some(Owner::Rest) {
            continue;
        }
        labels.set(voxel, Owner::Segment(segment));
        let centre = grid.centre(voxel);
        for next in grid.neighbours(voxel).map(|neighbour| neighbour.voxel) {
            if labels.owner(next) == Some(Owner::Rest) {
                let beyond = grid.centre(next);
                if osteotomy.admits(segment, &beyond) && !osteotomy.severs(&centre, &beyond) {
                    reach(&mut waiting, next, segment);
                }
            }
        }
    }
}
