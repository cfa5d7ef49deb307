//! Whether every part of a mesh is held against all six rigid movements.

use nalgebra::{Matrix6, Vector6};

use super::hold::Hold;
use crate::mesh::{Vector, VolumeMesh};

/// A rigid movement is held when its eigenvalue exceeds this share of the largest one.
/// Below it a part a thousand times its held patch across could turn freely.
const HELD: f64 = 1e-9;

/// A connected part of the mesh that some rigid movement can carry away.
#[derive(Clone, Debug, PartialEq)]
pub struct LoosePart {
    pub nodes: usize,
    /// Its lowest node.
    pub first_node: u32,
    /// How many of the six rigid movements nothing holds.
    pub free_movements: usize,
}

/// The parts of the mesh, connected by cells, that the holds do not keep in place.
pub fn loose_parts(mesh: &VolumeMesh, holds: &[Hold]) -> Vec<LoosePart> {
    let parts = connected_parts(mesh);
    let mut grams = vec![Matrix6::<f64>::zeros(); parts.centres.len()];
    for hold in holds {
        let part = parts.of_node[hold.node as usize];
        if part == u32::MAX {
            continue;
        }
        let part = part as usize;
        let arm = (mesh.nodes[hold.node as usize] - parts.centres[part]) / parts.radii[part];
        for held in 0..hold.count() {
            let axis: Vector = hold.axes().column(held).into_owned();
            let turn = arm.cross(&axis);
            let row = Vector6::new(axis.x, axis.y, axis.z, turn.x, turn.y, turn.z);
            grams[part] += row * row.transpose();
        }
    }
    let mut loose = Vec::new();
    for (part, gram) in grams.iter().enumerate() {
        let eigenvalues = gram.symmetric_eigenvalues();
        let largest = eigenvalues.max();
        let free_movements = match largest > 0.0 {
            true => eigenvalues.iter().filter(|value| **value <= HELD * largest).count(),
            false => 6,
        };
        if free_movements > 0 {
            let (nodes, first_node) = (parts.sizes[part], parts.first_nodes[part]);
            loose.push(LoosePart { nodes, first_node, free_movements });
        }
    }
    loose
}

struct Parts {
    /// The part of each node, in the order of their lowest nodes; `u32::MAX` for nodes without a cell.
    of_node: Vec<u32>,
    first_nodes: Vec<u32>,
    sizes: Vec<usize>,
    centres: Vec<Vector>,
    /// The largest distance of a node from the centre.
    radii: Vec<f64>,
}

fn connected_parts(mesh: &VolumeMesh) -> Parts {
    let root_of = roots(mesh);
    let mut parts = Parts {
        of_node: vec![u32::MAX; mesh.nodes.len()],
        first_nodes: Vec::new(),
        sizes: Vec::new(),
        centres: Vec::new(),
        radii: Vec::new(),
    };
    // A root is the lowest node of its part, so it is met before the others.
    for (node, &root) in root_of.iter().enumerate().filter(|(_, root)| **root != u32::MAX) {
        if root as usize == node {
            parts.of_node[node] = parts.first_nodes.len() as u32;
            parts.first_nodes.push(root);
            parts.sizes.push(0);
            parts.centres.push(Vector::zeros());
            parts.radii.push(0.0);
        }
        let part = parts.of_node[root as usize];
        parts.of_node[node] = part;
        parts.sizes[part as usize] += 1;
        parts.centres[part as usize] += mesh.nodes[node];
    }
    for (centre, size) in parts.centres.iter_mut().zip(&parts.sizes) {
        *centre /= *size as f64;
    }
    for (node, &part) in parts.of_node.iter().enumerate().filter(|(_, part)| **part != u32::MAX) {
        let distance = (mesh.nodes[node] - parts.centres[part as usize]).norm();
        let radius = &mut parts.radii[part as usize];
        *radius = radius.max(distance);
    }
    parts
}

/// For each node of a cell the lowest node of its part: union by cells with path halving.
fn roots(mesh: &VolumeMesh) -> Vec<u32> {
    let mut parent: Vec<u32> = vec![u32::MAX; mesh.nodes.len()];
    for (_, nodes) in mesh.cells.iter() {
        for &node in nodes {
            if parent[node as usize] == u32::MAX {
                parent[node as usize] = node;
            }
        }
        for pair in nodes.windows(2) {
            let (a, b) = (find(&mut parent, pair[0]), find(&mut parent, pair[1]));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    for node in 0..parent.len() {
        if parent[node] != u32::MAX {
            parent[node] = find(&mut parent, node as u32);
        }
    }
    parent
}

fn find(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let grandparent = parent[parent[node as usize] as usize];
        parent[node as usize] = grandparent;
        node = grandparent;
    }
    node
}
