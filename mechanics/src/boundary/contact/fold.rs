//! Neighbourhoods of nodes over few cells of tissue: the two sides of one fold are not in contact with each other.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::mesh::VolumeMesh;
use crate::rows::Rows;

/// Nodes this many cells of tissue apart, or fewer, are of one fold.
const FOLD: usize = 4;

/// The folds of a mesh, each found when it is first asked for.
pub(super) struct Folds<'a> {
    mesh: &'a VolumeMesh,
    /// The cells around each node.
    around: Rows<u32>,
    /// For each node those of its fold but itself, ascending.
    of_node: Vec<OnceLock<Vec<u32>>>,
}

impl<'a> Folds<'a> {
    pub fn new(mesh: &'a VolumeMesh) -> Self {
        let around = mesh.cells.around(mesh.nodes.len());
        let of_node = mesh.nodes.iter().map(|_| OnceLock::new()).collect();
        Folds { mesh, around, of_node }
    }

    /// Whether one of some nodes is of the fold of another one.
    pub fn are_near(&self, node: u32, others: &[u32; 3]) -> bool {
        let fold = self.of_node[node as usize].get_or_init(|| self.around(node));
        others.iter().any(|other| fold.binary_search(other).is_ok())
    }

    fn around(&self, first: u32) -> Vec<u32> {
        let mut seen = BTreeSet::from([first]);
        let mut ring = vec![first];
        for _ in 0..FOLD {
            let cells: BTreeSet<u32> =
                ring.iter().flat_map(|&node| self.around.row(node as usize)).copied().collect();
            let reached = cells.iter().flat_map(|&cell| self.mesh.cells.nodes(cell as usize));
            ring = reached.copied().filter(|&node| seen.insert(node)).collect();
        }
        seen.remove(&first);
        seen.into_iter().collect()
    }
}
