//! Boundary conditions as case and plan state them, each with its place.

use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};

/// A condition of the case or the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedCondition {
    /// JSON pointer, e.g. `/case/sliding/0`.
    pub pointer: String,
    /// The segment that moves it.
    pub segment: Option<u32>,
    /// The nodes that it names.
    pub nodes: Vec<u32>,
    pub constraints: StatedHold,
}

/// Components that a boundary condition constrains; of several at one node the first in this order prevails.
#[derive(Clone, Debug, PartialEq)]
pub enum StatedHold {
    /// Prescribed components.
    Components([bool; 3]),
    /// Nodes of a segment.
    Joined,
    Fixed,
    /// Unit normals of the walls of each node.
    Walls(Vec<Vec<Vector>>),
}

impl StatedCondition {
    /// Of its nodes.
    pub(super) fn nodes_without_extent(
        &self,
        mesh: &VolumeMesh,
        boundary: &[BoundaryFace],
    ) -> Vec<u32> {
        nodes_without_extent(&self.nodes, mesh, boundary)
    }
}

/// Those of some nodes that belong to no face of the boundary and to no cell all of whose nodes are among them: points and lines, and
/// sheets inside the tissue.
pub(super) fn nodes_without_extent(
    nodes: &[u32],
    mesh: &VolumeMesh,
    boundary: &[BoundaryFace],
) -> Vec<u32> {
    let mut is_own = vec![false; mesh.nodes.len()];
    nodes.iter().for_each(|&node| is_own[node as usize] = true);
    let faces = boundary.iter().map(BoundaryFace::nodes);
    let cells = mesh.cells.iter().map(|(_, nodes)| nodes);
    let mut has_extent = vec![false; mesh.nodes.len()];
    for filled in faces.chain(cells) {
        if filled.iter().all(|&node| is_own[node as usize]) {
            filled.iter().for_each(|&node| has_extent[node as usize] = true);
        }
    }
    nodes.iter().copied().filter(|&node| !has_extent[node as usize]).collect()
}
