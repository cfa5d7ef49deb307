//! Bones that touch, taken apart: each voxel goes to the seed from which it is reached through the thickest bone.
//!
//! A watershed of the distance to the surface of the bone (Vincent and Soille 1991), flooded from seeds: teeth that touch
//! and the joint of the jaw are where bone is thin between two thick parts.

use std::collections::BinaryHeap;

use super::distance::squared_distance;
use super::mask::{Grid, Mask};

/// Where one of the bones is for certain.
#[derive(Clone, Debug, PartialEq)]
pub struct Seed {
    /// Numbers of voxels; those outside the bone are passed over.
    pub voxels: Vec<usize>,
}

/// A voxel that is reached, ordered by how thick bone was on the way, then by who came first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct FrontVoxel {
    /// Bits of a positive number in single precision, which are ordered like it.
    thickness: u32,
    earlier: std::cmp::Reverse<u64>,
    voxel: usize,
    seed: usize,
}

/// The way from a seed to where its bone is thickest: a seed near the surface would be flooded from afar.
fn climb(grid: &Grid, depth: &[f32], seed: usize) -> Vec<usize> {
    let mut way = vec![seed];
    let mut here = seed;
    let deepest =
        |voxel: usize| grid.neighbours(voxel).max_by(|&a, &b| depth[a].total_cmp(&depth[b]));
    while let Some(next) = deepest(here).filter(|&next| depth[next] > depth[here]) {
        way.push(next);
        here = next;
    }
    way
}

/// For each voxel the number of its seed; `None` outside the mask and in pieces without a seed.
pub fn separated(mask: &Mask, seeds: &[Seed]) -> Vec<Option<usize>> {
    let depth = squared_distance(&mask.complement());
    let mut owner = vec![None; mask.inside.len()];
    let mut heap = BinaryHeap::new();
    let mut count = 0;
    let mut reach =
        |heap: &mut BinaryHeap<FrontVoxel>, voxel: usize, seed: usize, thickness: f32| {
            count += 1;
            let earlier = std::cmp::Reverse(count);
            heap.push(FrontVoxel { thickness: thickness.to_bits(), earlier, voxel, seed });
        };
    for (seed, Seed { voxels }) in seeds.iter().enumerate() {
        for &voxel in voxels.iter().filter(|&&voxel| mask.inside[voxel]) {
            for voxel in climb(&mask.grid, &depth, voxel) {
                reach(&mut heap, voxel, seed, f32::INFINITY);
            }
        }
    }
    while let Some(FrontVoxel { thickness, voxel, seed, .. }) = heap.pop() {
        if owner[voxel].is_some() {
            continue;
        }
        owner[voxel] = Some(seed);
        for next in mask.grid.neighbours(voxel) {
            if mask.inside[next] && owner[next].is_none() {
                reach(&mut heap, next, seed, depth[next].min(f32::from_bits(thickness)));
            }
        }
    }
    owner
}
