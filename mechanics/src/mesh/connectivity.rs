//! Neighbours of cells across their faces.

use rayon::prelude::*;

use super::VolumeMesh;
use super::disjoint_sets::DisjointSets;
use super::volume::BoundaryFace;
use crate::rows::{Rows, Sorting};

/// A face of a cell: its nodes without the lowest, ascending (`u32::MAX` for the fourth of a triangle), then the cell and which
/// of its faces it is, in one number, which sorts faster than an array does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CellFace(u128);

/// Bits of a [`CellFace`] after its nodes, and those of them that number the face of the cell.
const CELL_BITS: u32 = 32;
const LOCAL_BITS: u32 = 3;

impl CellFace {
    /// The lowest of the nodes of a face of a cell with these nodes, and the rest of it.
    fn new(cell: usize, cell_nodes: &[u32], local: usize, face: &[usize]) -> (u32, CellFace) {
        let mut nodes = [u32::MAX; 4];
        for (slot, &node) in nodes.iter_mut().zip(face) {
            *slot = cell_nodes[node];
        }
        nodes.sort_unstable();
        let [lowest, others @ ..] = nodes;
        let others = others.iter().fold(0, |bits, &node| bits << 32 | u128::from(node));
        let number = (cell << LOCAL_BITS | local) as u128;
        (lowest, CellFace(others << CELL_BITS | number))
    }

    /// Whether two faces with the same lowest node have the same nodes.
    fn has_nodes_of(&self, other: &CellFace) -> bool {
        self.0 >> CELL_BITS == other.0 >> CELL_BITS
    }

    fn cell(self) -> u32 {
        self.0 as u32 >> LOCAL_BITS
    }

    fn local(self) -> u8 {
        self.0 as u8 & ((1 << LOCAL_BITS) - 1)
    }
}

/// All faces of all cells, those with the same nodes side by side.
pub struct Faces {
    /// Of each node those of which it is the lowest.
    of_lowest: Rows<CellFace>,
    cells: usize,
}

impl Faces {
    /// There are at most 2^29 cells.
    pub fn new(mesh: &VolumeMesh) -> Self {
        assert!(mesh.cells.len() <= 1 << (CELL_BITS - LOCAL_BITS), "2^29 cells at most");
        // A counting sort by the lowest node leaves some twenty faces to sort at each.
        let mut lengths = vec![0_u32; mesh.nodes.len()];
        for (shape, nodes) in mesh.cells.iter() {
            for face in shape.faces() {
                let lowest = face.iter().map(|&local| nodes[local]).min();
                lowest.into_iter().for_each(|lowest| lengths[lowest as usize] += 1);
            }
        }
        let mut sorting = Sorting::new(&lengths, CellFace::default());
        for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
            for (local, face) in shape.faces().iter().enumerate() {
                let (lowest, face) = CellFace::new(cell, nodes, local, face);
                sorting.put(lowest as usize, face);
            }
        }
        let mut of_lowest = sorting.finish();
        of_lowest.rows_mut().into_par_iter().for_each(<[_]>::sort_unstable);
        Faces { of_lowest, cells: mesh.cells.len() }
    }

    /// The faces with the same nodes, one group after the other.
    pub(super) fn shared(&self) -> impl Iterator<Item = &[CellFace]> {
        self.of_lowest.iter().flat_map(|faces| faces.chunk_by(CellFace::has_nodes_of))
    }

    /// For each cell the number of its part: cells that share a face belong together. Parts are numbered
    /// in the order of their lowest cells. Parts that touch in a node or an edge only stay apart.
    pub fn parts(&self) -> Vec<u32> {
        let mut sets = DisjointSets::new(self.cells);
        for pair in self.shared().flat_map(|same| same.windows(2)) {
            sets.join(pair[0].cell(), pair[1].cell());
        }
        sets.numbers().0
    }
}

/// For each cell the number of its part: cells that share a node belong together. Parts are numbered in the order of
/// their lowest cells. `by_faces` are the parts of cells that share faces.
pub fn parts_by_nodes(mesh: &VolumeMesh, by_faces: &[u32]) -> Vec<u32> {
    let count = by_faces.iter().max().map_or(0, |last| *last as usize + 1);
    if count < 2 {
        return by_faces.to_vec();
    }
    let mut joined = DisjointSets::new(count);
    let mut part_of_node = vec![u32::MAX; mesh.nodes.len()];
    for ((_, nodes), &part) in mesh.cells.iter().zip(by_faces) {
        for &node in nodes {
            let other = std::mem::replace(&mut part_of_node[node as usize], part);
            if other != u32::MAX && other != part {
                joined.join(other, part);
            }
        }
    }
    let (number, _) = joined.numbers();
    by_faces.iter().map(|&part| number[part as usize]).collect()
}

impl VolumeMesh {
    /// The faces that belong to one cell only, in the order of cells and of the faces of each.
    pub fn boundary_faces(&self) -> Vec<BoundaryFace> {
        self.boundary_of(&Faces::new(self))
    }

    /// The same from faces that are known already.
    pub fn boundary_of(&self, faces: &Faces) -> Vec<BoundaryFace> {
        let alone = faces.shared().filter(|same| same.len() == 1);
        let mut alone: Vec<(u32, u8)> =
            alone.map(|same| (same[0].cell(), same[0].local())).collect();
        alone.par_sort_unstable();
        alone.into_iter().map(|(cell, local)| self.face(cell, local)).collect()
    }
}
