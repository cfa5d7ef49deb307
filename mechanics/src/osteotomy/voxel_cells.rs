//! Cells of a mesh that hold the centres of voxels of bone, and of the voxels beside bone.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::bone_labels::BoneLabels;
use crate::mesh::{Vector, VolumeMesh};

/// Voxels so far from bone, along one axis, count as beside it: its boundary in a mesh lies up to a voxel or so off.
const BESIDE: usize = 2;
/// A place so far outside a cell, as a part of its height, lies on its face.
const ON_FACE: f64 = 1e-9;

/// For voxels of bone and beside it the cell of tissue that holds their centres.
pub struct VoxelCells {
    /// Ascending by voxel.
    found: Vec<(u32, u32)>,
}

impl VoxelCells {
    /// The mesh is of tetrahedra.
    pub fn new(mesh: &VolumeMesh, labels: &BoneLabels) -> VoxelCells {
        let near = near_bone(labels);
        let cells: Vec<u32> = (0..mesh.cells.len() as u32).collect();
        let lists = cells.par_chunks(1 << 10).map(|cells| {
            let mut list = Vec::new();
            for &cell in cells {
                let corners: Vec<Vector> =
                    mesh.corners(cell as usize).map(|corner| labels.index_of(&corner)).collect();
                let [a, b, c, d] = corners[..] else { continue };
                voxels_in([a, b, c, d], labels.size(), &near, |voxel| list.push((voxel, cell)));
            }
            list
        });
        let mut found: Vec<(u32, u32)> = lists.collect::<Vec<_>>().concat();
        found.par_sort_unstable();
        found.dedup_by_key(|(voxel, _)| *voxel);
        VoxelCells { found }
    }

    /// Voxels with the cells that hold them.
    pub fn iter(&self) -> impl IndexedParallelIterator<Item = (usize, usize)> + '_ {
        self.found.par_iter().map(|&(voxel, cell)| (voxel as usize, cell as usize))
    }

    pub fn is_held(&self, voxel: usize) -> bool {
        self.found.binary_search_by_key(&voxel, |(held, _)| *held as usize).is_ok()
    }
}

/// For each voxel whether it is of bone that holds tissue, or beside such bone.
fn near_bone(labels: &BoneLabels) -> Vec<bool> {
    let size = labels.size();
    let strides = [1, size[0], size[0] * size[1]];
    let count = strides[2] * size[2];
    let mut near = vec![false; count];
    for voxel in (0..count).filter(|&voxel| labels.holds(voxel)) {
        near[voxel] = true;
        let place = [voxel % size[0], voxel / size[0] % size[1], voxel / strides[2]];
        for axis in 0..3 {
            for step in 1..=BESIDE {
                if place[axis] >= step {
                    near[voxel - step * strides[axis]] = true;
                }
                if place[axis] + step < size[axis] {
                    near[voxel + step * strides[axis]] = true;
                }
            }
        }
    }
    near
}

/// Calls with the voxels near bone that have their centres in a tetrahedron, whose corners are in voxels.
fn voxels_in(corners: [Vector; 4], size: [usize; 3], near: &[bool], mut found: impl FnMut(u32)) {
    let [first, a, b, c] = corners;
    let edges = Matrix3::from_columns(&[a - first, b - first, c - first]);
    let Some(to_shares) = edges.try_inverse() else { return };
    let low = corners.iter().fold(first, |low, corner| low.inf(corner));
    let high = corners.iter().fold(first, |high, corner| high.sup(corner));
    let range = |axis: usize| {
        let end = (high[axis].floor() + 1.0).clamp(0.0, size[axis] as f64) as usize;
        low[axis].ceil().max(0.0) as usize..end
    };
    for k in range(2) {
        for j in range(1) {
            let row = size[0] * (j + size[1] * k);
            for i in range(0).filter(|i| near[row + i]) {
                let shares = to_shares * (Vector::new(i as f64, j as f64, k as f64) - first);
                if shares.min() >= -ON_FACE && shares.sum() <= 1.0 + ON_FACE {
                    found((row + i) as u32);
                }
            }
        }
    }
}
