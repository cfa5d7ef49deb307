//! Held neighbours that part: where a plan tears the tissue at an osteotomy (docs/verification.md#v27), and where it moves what
//! holds tissue through something else that does.

use std::collections::BTreeSet;

use super::conditions::{Conditions, NodeClass};
use crate::mesh::{Vector, VolumeMesh, Warning};

/// A difference of displacement above this share of the edge it spans tears.
const TEARING: f64 = 1.0;

/// Edges of cells that are turned by more than a right angle: what holds their ends passes through each other, as no operation
/// does, and presses the tissue between flat.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedEdges {
    pub edges: usize,
    /// Those that have one of them.
    pub cells: usize,
    /// The middle of the one that is turned the farthest in its lengths, in mm.
    pub at: Vector,
    /// What holds their ends.
    pub between: BTreeSet<[NodeClass; 2]>,
}

/// A warning that counts the edges between wholly held nodes along which |du| / h exceeds 1, and those that are turned round.
pub fn tearing(
    mesh: &VolumeMesh,
    conditions: &Conditions,
    name: impl Fn(NodeClass) -> String,
) -> Option<Warning> {
    let mut torn: Vec<[u32; 2]> = Vec::new();
    let (mut worst, mut worst_edge) = (0.0, [0, 0]);
    each_held_edge(mesh, conditions, |HeldEdge { nodes, along, parts, .. }| {
        let ratio = parts.norm() / along.norm();
        if ratio > TEARING {
            torn.push(nodes);
        }
        if ratio > worst {
            (worst, worst_edge) = (ratio, nodes);
        }
    });
    torn.sort_unstable();
    torn.dedup();
    if torn.is_empty() {
        return None;
    }
    let [a, b] = worst_edge;
    let turned = turned_edges(mesh, conditions);
    let through =
        turned.as_ref().map_or_else(String::new, |turned| format!("; {}", turned.told(name)));
    let detail = format!(
        "tearing between segments or beside what is fixed: {} edges between held nodes are displaced by more than their length, \
         worst between nodes {a} and {b}{through}",
        torn.len()
    );
    let warning = Warning::new("tearing", detail).with("edges", torn.len() as f64);
    let warning = warning.with("largest_ratio", worst);
    Some(turned.iter().fold(warning, |warning, turned| {
        let warning = warning.with("turned_edges", turned.edges as f64);
        let warning = warning.with("turned_cells", turned.cells as f64);
        let TurnedEdges { at, .. } = turned;
        warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z)
    }))
}

/// The edges that are turned round, between nodes that are held by different things; none where no edge is.
pub fn turned_edges(mesh: &VolumeMesh, conditions: &Conditions) -> Option<TurnedEdges> {
    let (mut edges, mut cells) = (BTreeSet::new(), BTreeSet::new());
    let (mut between, mut farthest, mut at) = (BTreeSet::new(), f64::INFINITY, Vector::zeros());
    each_held_edge(mesh, conditions, |HeldEdge { cell, nodes, along, parts }| {
        let [a, b] = nodes.map(|node| conditions.classes[node as usize]);
        let left = 1.0 + parts.dot(&along) / along.norm_squared();
        if a == b || left > 0.0 {
            return;
        }
        edges.insert(nodes);
        cells.insert(cell);
        between.insert([a.min(b), a.max(b)]);
        if left < farthest {
            (farthest, at) = (left, mesh.nodes[nodes[0] as usize] + 0.5 * along);
        }
    });
    let (edges, cells) = (edges.len(), cells.len());
    (edges > 0).then_some(TurnedEdges { edges, cells, at, between })
}

impl TurnedEdges {
    /// In words, with names for what holds.
    pub fn told(&self, name: impl Fn(NodeClass) -> String) -> String {
        let TurnedEdges { edges, cells, at, between } = self;
        let pairs: Vec<String> = between.iter().map(|pair| pair.map(&name).join(" and ")).collect();
        format!(
            "the movement turns {edges} edges of {cells} cells between held nodes round, the farthest at ({:.1}, {:.1}, {:.1}) mm: {} \
             pass through each other there, which no bone does, and press the tissue between them flat",
            at.x,
            at.y,
            at.z,
            pairs.join(", ")
        )
    }
}

/// An edge of a cell whose ends are wholly held, from the lower to the higher node.
struct HeldEdge {
    cell: usize,
    nodes: [u32; 2],
    /// From one end to the other at rest, and how much farther it leads after the movement, in mm.
    along: Vector,
    parts: Vector,
}

fn each_held_edge(mesh: &VolumeMesh, conditions: &Conditions, mut seen: impl FnMut(HeldEdge)) {
    let mut displacement: Vec<Option<Vector>> = vec![None; mesh.nodes.len()];
    for constraint in conditions.constraints.iter().filter(|constraint| constraint.count() == 3) {
        displacement[constraint.node as usize] = Some(constraint.axes() * constraint.values());
    }
    for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
        // Most cells have no two held nodes.
        if nodes.iter().filter(|node| displacement[**node as usize].is_some()).nth(1).is_none() {
            continue;
        }
        for [a, b] in shape.edges().iter().map(|edge| edge.map(|local| nodes[local])) {
            let [a, b] = [a.min(b), a.max(b)];
            let ends = [a, b].map(|node| displacement[node as usize]);
            let [Some(of_a), Some(of_b)] = ends else { continue };
            let along = mesh.nodes[b as usize] - mesh.nodes[a as usize];
            seen(HeldEdge { cell, nodes: [a, b], along, parts: of_b - of_a });
        }
    }
}
