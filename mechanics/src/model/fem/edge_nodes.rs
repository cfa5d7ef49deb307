//! Nodes in the middle of the edges of tetrahedra.

use crate::boundary::{Hold, midpoint};
use crate::element::tetrahedron10;
use crate::mesh::{Vector, VolumeMesh};
use rayon::prelude::*;

/// The middles of the edges of a mesh of tetrahedra, numbered after its nodes.
pub struct EdgeNodes {
    /// The two ends of each edge, the lower first; edges ascending.
    ends: Vec<[u32; 2]>,
    corners: usize,
}

impl EdgeNodes {
    pub fn new(mesh: &VolumeMesh) -> Self {
        let edges = mesh.cells.iter().flat_map(|(shape, nodes)| {
            shape.edges().iter().map(move |&[a, b]| sorted([nodes[a], nodes[b]]))
        });
        let mut ends: Vec<[u32; 2]> = edges.collect();
        ends.par_sort_unstable();
        ends.dedup();
        EdgeNodes { ends, corners: mesh.nodes.len() }
    }

    /// Nodes of the mesh and of its edges.
    pub fn node_count(&self) -> usize {
        self.corners + self.ends.len()
    }

    /// The node in the middle of an edge of the mesh.
    pub fn between(&self, a: u32, b: u32) -> u32 {
        let edge = self.ends.binary_search(&sorted([a, b]));
        (self.corners + edge.expect("both nodes belong to one cell of the mesh")) as u32
    }

    /// The positions of all nodes in mm.
    pub fn positions(&self, mesh: &VolumeMesh) -> Vec<Vector> {
        let middle = |[a, b]: &[u32; 2]| (mesh.nodes[*a as usize] + mesh.nodes[*b as usize]) * 0.5;
        mesh.nodes.iter().copied().chain(self.ends.iter().map(middle)).collect()
    }

    /// The ten nodes of a cell, corners first.
    pub fn of_cell(&self, mesh: &VolumeMesh, cell: usize) -> [u32; 10] {
        let corners = mesh.cells.nodes(cell);
        std::array::from_fn(|k| match k {
            0..4 => corners[k],
            _ => {
                let [a, b] = tetrahedron10::EDGES[k - 4];
                self.between(corners[a], corners[b])
            }
        })
    }

    /// The holds and, after them, those of edge nodes that have none of their own yet; with the two holds
    /// between which each of these lies.
    pub(super) fn holds(&self, mesh: &VolumeMesh, holds: &[Hold]) -> (Vec<Hold>, Vec<[usize; 2]>) {
        let mut hold_of = vec![None; self.node_count()];
        for (index, hold) in holds.iter().enumerate() {
            hold_of[hold.node as usize] = Some(index);
        }
        let mut all = holds.to_vec();
        let mut parents = Vec::new();
        for face in mesh.boundary_faces() {
            let nodes = face.nodes();
            let Some(held) =
                nodes.iter().map(|&n| hold_of[n as usize]).collect::<Option<Vec<usize>>>()
            else {
                continue;
            };
            for side in 0..nodes.len() {
                let next = (side + 1) % nodes.len();
                let middle = self.between(nodes[side], nodes[next]);
                if hold_of[middle as usize].is_some() {
                    continue;
                }
                let [a, b] = [held[side], held[next]];
                if let Some(hold) = midpoint::between(middle, &holds[a], &holds[b]) {
                    hold_of[middle as usize] = Some(all.len());
                    all.push(hold);
                    parents.push([a, b]);
                }
            }
        }
        (all, parents)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
