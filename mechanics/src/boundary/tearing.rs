//! Held neighbours that part: where a plan tears the tissue at an osteotomy (docs/verification.md#v27), and where it moves what
//! holds tissue through something else that does.

use std::collections::{BTreeMap, BTreeSet};

use super::conditions::{Conditions, NodeClass};
use crate::mesh::{Vector, VolumeMesh, Warning};

/// A difference of displacement above this share of the edge it spans tears.
const TEARING: f64 = 1.0;

/// Edges of cells that are turned by more than a right angle: what holds their ends passes through each other, as no operation
/// does, and presses the tissue between flat.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedEdges {
    pub edges: usize,
    /// Those that have one of them; 0 where edges are kept without their cells.
    pub cells: usize,
    /// The middle of the one that is turned the farthest in its lengths, in mm.
    pub at: Vector,
    /// What holds their ends.
    pub between: BTreeSet<[NodeClass; 2]>,
}

/// An edge of cells whose ends are held by different things: two segments, or a segment and what stays.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeBetween {
    pub nodes: [u32; 2],
    /// Where they are at rest, in mm.
    pub ends: [Vector; 2],
    pub held_by: [NodeClass; 2],
}

/// A warning that counts the edges between wholly held nodes along which |du| / h exceeds 1, and those that are turned round.
pub fn tearing(
    mesh: &VolumeMesh,
    conditions: &Conditions,
    name: impl Fn(NodeClass) -> String,
) -> Option<Warning> {
    warning(|seen| each_held_edge(mesh, conditions, seen), name)
}

/// The same for edges that are kept of a mesh, each once, and what moves their ends.
pub fn tearing_between(
    edges: &[EdgeBetween],
    displacement: impl Fn(NodeClass, &Vector) -> Vector,
    name: impl Fn(NodeClass) -> String,
) -> Option<Warning> {
    let each = |seen: &mut dyn FnMut(HeldEdge)| {
        for EdgeBetween { nodes, ends, held_by } in edges {
            let [of_a, of_b] = [0, 1].map(|end| displacement(held_by[end], &ends[end]));
            let (from, along, parts) = (ends[0], ends[1] - ends[0], of_b - of_a);
            seen(HeldEdge { cell: None, nodes: *nodes, held_by: *held_by, from, along, parts });
        }
    };
    warning(each, name)
}

/// The edges of a mesh between nodes that are wholly held by different things, each once.
pub fn edges_between(mesh: &VolumeMesh, conditions: &Conditions) -> Vec<EdgeBetween> {
    let mut edges = BTreeMap::new();
    each_held_edge(mesh, conditions, &mut |HeldEdge { nodes, held_by, from, along, .. }| {
        if held_by[0] != held_by[1] {
            edges.insert(nodes, EdgeBetween { nodes, ends: [from, from + along], held_by });
        }
    });
    edges.into_values().collect()
}

/// The edges that are turned round, between nodes that are held by different things; none where no edge is.
pub fn turned_edges(mesh: &VolumeMesh, conditions: &Conditions) -> Option<TurnedEdges> {
    turned(|seen| each_held_edge(mesh, conditions, seen))
}

fn warning(
    each: impl Fn(&mut dyn FnMut(HeldEdge)),
    name: impl Fn(NodeClass) -> String,
) -> Option<Warning> {
    let mut torn: Vec<[u32; 2]> = Vec::new();
    let (mut worst, mut worst_edge) = (0.0, [0, 0]);
    each(&mut |HeldEdge { nodes, along, parts, .. }| {
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
    let turned = turned(each);
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
        let TurnedEdges { edges, cells, at, .. } = turned;
        let mut warning = warning.with("turned_edges", *edges as f64);
        if *cells > 0 {
            warning = warning.with("turned_cells", *cells as f64);
        }
        warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z)
    }))
}

fn turned(each: impl Fn(&mut dyn FnMut(HeldEdge))) -> Option<TurnedEdges> {
    let (mut edges, mut cells) = (BTreeSet::new(), BTreeSet::new());
    let (mut between, mut farthest, mut at) = (BTreeSet::new(), f64::INFINITY, Vector::zeros());
    each(&mut |HeldEdge { cell, nodes, held_by: [a, b], from, along, parts }| {
        let left = 1.0 + parts.dot(&along) / along.norm_squared();
        if a == b || left > 0.0 {
            return;
        }
        edges.insert(nodes);
        cells.extend(cell);
        between.insert([a.min(b), a.max(b)]);
        if left < farthest {
            (farthest, at) = (left, from + 0.5 * along);
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
        let of_cells = if *cells > 0 { format!(" of {cells} cells") } else { String::new() };
        format!(
            "the movement turns {edges} edges{of_cells} between held nodes round, the farthest at ({:.1}, {:.1}, {:.1}) mm: {} \
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
    cell: Option<usize>,
    nodes: [u32; 2],
    held_by: [NodeClass; 2],
    /// The lower node at rest, in mm.
    from: Vector,
    /// From one end to the other at rest, and how much farther it leads after the movement, in mm.
    along: Vector,
    parts: Vector,
}

fn each_held_edge(mesh: &VolumeMesh, conditions: &Conditions, seen: &mut dyn FnMut(HeldEdge)) {
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
            let from = mesh.nodes[a as usize];
            let (along, parts) = (mesh.nodes[b as usize] - from, of_b - of_a);
            let held_by = [a, b].map(|node| conditions.classes[node as usize]);
            // What one segment carries turns with it, by any angle.
            if held_by[0] == held_by[1] && matches!(held_by[0], NodeClass::Joined(_)) {
                continue;
            }
            seen(HeldEdge { cell: Some(cell), nodes: [a, b], held_by, from, along, parts });
        }
    }
}
