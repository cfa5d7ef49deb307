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
    let mut torn: Vec<(u32, u32)> = Vec::new();
    let (mut worst, mut worst_edge) = (0.0, (0, 0));
    for HeldEdge { nodes: [a, b], along, parts, .. } in held_edges(mesh, conditions) {
        let ratio = parts.norm() / along.norm();
        if ratio > TEARING {
            torn.push((a, b));
        }
        if ratio > worst {
            (worst, worst_edge) = (ratio, (a, b));
        }
    }
    torn.sort_unstable();
    torn.dedup();
    if torn.is_empty() {
        return None;
    }
    let (a, b) = worst_edge;
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
    for HeldEdge { cell, nodes, along, parts } in held_edges(mesh, conditions) {
        let [a, b] = nodes.map(|node| conditions.classes[node as usize]);
        let left = 1.0 + parts.dot(&along) / along.norm_squared();
        if a == b || left > 0.0 {
            continue;
        }
        edges.insert(nodes);
        cells.insert(cell);
        between.insert([a.min(b), a.max(b)]);
        if left < farthest {
            (farthest, at) = (left, mesh.nodes[nodes[0] as usize] + 0.5 * along);
        }
    }
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

fn held_edges<'a>(
    mesh: &'a VolumeMesh,
    conditions: &Conditions,
) -> impl Iterator<Item = HeldEdge> + use<'a> {
    let mut displacement: Vec<Option<Vector>> = vec![None; mesh.nodes.len()];
    for constraint in conditions.constraints.iter().filter(|constraint| constraint.count() == 3) {
        displacement[constraint.node as usize] = Some(constraint.axes() * constraint.values());
    }
    mesh.cells.iter().enumerate().flat_map(move |(cell, (shape, nodes))| {
        let edges = shape.edges().iter().map(|edge| edge.map(|local| nodes[local]));
        let held = edges.filter_map(|[a, b]| {
            let [a, b] = [a.min(b), a.max(b)];
            let parts = displacement[b as usize]? - displacement[a as usize]?;
            let along = mesh.nodes[b as usize] - mesh.nodes[a as usize];
            Some(HeldEdge { cell, nodes: [a, b], along, parts })
        });
        held.collect::<Vec<_>>()
    })
}
