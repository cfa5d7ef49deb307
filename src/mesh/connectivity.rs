//! Which cells share a face.

use rayon::prelude::*;

use super::VolumeMesh;

/// A face of a cell under the sorted nodes that it shares with its neighbour; a triangle's fourth node
/// is `u32::MAX`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SharedFace {
    pub nodes: [u32; 4],
    pub cell: u32,
    pub local: u8,
}

/// All faces of all cells, those with the same nodes side by side.
pub(super) fn sorted_faces(mesh: &VolumeMesh) -> Vec<SharedFace> {
    let mut faces = Vec::with_capacity(mesh.cells.len() * 4);
    for (cell, (shape, cell_nodes)) in mesh.cells.iter().enumerate() {
        for (local, face) in shape.faces().iter().enumerate() {
            let mut nodes = [u32::MAX; 4];
            for (slot, &node) in nodes.iter_mut().zip(*face) {
                *slot = cell_nodes[node];
            }
            nodes.sort_unstable();
            faces.push(SharedFace { nodes, cell: cell as u32, local: local as u8 });
        }
    }
    faces.par_sort_unstable();
    faces
}

/// For each cell the number of its part: cells that share a face belong together. Parts are numbered
/// in the order of their lowest cells. Parts that touch in a node or an edge only stay apart.
pub fn parts_by_face(mesh: &VolumeMesh) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..mesh.cells.len() as u32).collect();
    for same in sorted_faces(mesh).chunk_by(|a, b| a.nodes == b.nodes) {
        for pair in same.windows(2) {
            let (a, b) = (root(&mut parent, pair[0].cell), root(&mut parent, pair[1].cell));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut part_of_root = vec![u32::MAX; parent.len()];
    let mut parts = 0;
    (0..parent.len() as u32)
        .map(|cell| {
            let root = root(&mut parent, cell) as usize;
            if part_of_root[root] == u32::MAX {
                part_of_root[root] = parts;
                parts += 1;
            }
            part_of_root[root]
        })
        .collect()
}

/// The lowest cell of the part so far, halving paths on the way.
fn root(parent: &mut [u32], mut cell: u32) -> u32 {
    while parent[cell as usize] != cell {
        parent[cell as usize] = parent[parent[cell as usize] as usize];
        cell = parent[cell as usize];
    }
    cell
}
