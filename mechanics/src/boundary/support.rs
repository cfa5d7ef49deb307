//! Support of a mesh: each connected part constrained against all six rigid movements.
//!
//! A part is what hangs together by faces. Parts that touch in a node or an edge only can hinge there;
//! their shared nodes hold a part as far as its neighbour is held itself.

use nalgebra::{Matrix6, Vector6};

use super::constraint::Constraint;
use super::freedom::{Freedom, free_movements};
use crate::mesh::{Vector, VolumeMesh};
use crate::rows::Rows;

/// A part of the mesh that some rigid movement can carry away.
#[derive(Clone, Debug, PartialEq)]
pub struct LoosePart {
    pub nodes: usize,
    /// Its lowest node.
    pub first_node: u32,
    /// The rigid movements that nothing holds.
    pub freedom: Freedom,
}

/// The parts of the mesh that the holds do not keep in place. `part_of_cell` is the part of each cell by faces.
pub fn loose_parts(
    mesh: &VolumeMesh,
    part_of_cell: &[u32],
    constraints: &[Constraint],
) -> Vec<LoosePart> {
    let mut parts = ConnectedBodies::new(mesh, part_of_cell);
    for constraint in constraints {
        for held in 0..constraint.count() {
            let axis = constraint.axes().column(held).into_owned();
            for &body in parts.of_node.row(constraint.node as usize) {
                parts.bodies[body as usize].constrain(&mesh.nodes[constraint.node as usize], &axis);
            }
        }
    }
    parts.hold_by_neighbours(mesh);
    parts
        .bodies
        .iter()
        .filter(|body| body.free_movements() > 0)
        .map(|body| LoosePart {
            nodes: body.nodes.len(),
            first_node: body.nodes[0],
            freedom: Freedom::of(&body.gram, &body.centre, body.radius),
        })
        .collect()
}

/// A part taken as rigid, and what holds it.
struct Body {
    /// Ascending.
    nodes: Vec<u32>,
    centre: Vector,
    /// The largest distance of a node from the centre.
    radius: f64,
    /// The sum of r r^T over held directions, r = (axis, arm x axis).
    gram: Matrix6<f64>,
}

impl Body {
    fn new(mesh: &VolumeMesh, nodes: Vec<u32>) -> Self {
        let position = |node: &u32| mesh.nodes[*node as usize];
        let centre = nodes.iter().map(position).sum::<Vector>() / nodes.len() as f64;
        let radius = nodes.iter().map(|node| (position(node) - centre).norm()).fold(0.0, f64::max);
        Body { nodes, centre, radius, gram: Matrix6::zeros() }
    }

    fn constrain(&mut self, at: &Vector, axis: &Vector) {
        let turn = ((at - self.centre) / self.radius).cross(axis);
        let row = Vector6::new(axis.x, axis.y, axis.z, turn.x, turn.y, turn.z);
        self.gram += row * row.transpose();
    }

    fn free_movements(&self) -> usize {
        free_movements(&self.gram)
    }
}

struct ConnectedBodies {
    bodies: Vec<Body>,
    /// Those of each node, ascending.
    of_node: Rows<u32>,
}

impl ConnectedBodies {
    fn new(mesh: &VolumeMesh, part_of_cell: &[u32]) -> Self {
        // Each node with each part around it; the same part mostly comes again and again.
        let mut last = vec![u32::MAX; mesh.nodes.len()];
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(mesh.nodes.len());
        for ((_, nodes), &part) in mesh.cells.iter().zip(part_of_cell) {
            for &node in nodes {
                if std::mem::replace(&mut last[node as usize], part) != part {
                    pairs.push((node, part));
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let count = part_of_cell.iter().max().map_or(0, |last| *last as usize + 1);
        let mut nodes_of: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut lengths = vec![0; mesh.nodes.len()];
        for &(node, part) in &pairs {
            nodes_of[part as usize].push(node);
            lengths[node as usize] += 1;
        }
        let of_node = Rows::of_lengths(&lengths, pairs.into_iter().map(|(_, part)| part).collect());
        let bodies = nodes_of.into_iter().map(|nodes| Body::new(mesh, nodes)).collect();
        ConnectedBodies { bodies, of_node }
    }

    /// Passes on from held bodies, through the nodes they share, until nothing changes.
    fn hold_by_neighbours(&mut self, mesh: &VolumeMesh) {
        let held = |body: &Body| body.free_movements() == 0;
        let mut waiting: Vec<usize> =
            (0..self.bodies.len()).filter(|b| held(&self.bodies[*b])).collect();
        let mut passed: Vec<bool> = self.bodies.iter().map(held).collect();
        while let Some(holder) = waiting.pop() {
            for node in self.bodies[holder].nodes.clone() {
                for &other in self.of_node.row(node as usize) {
                    let other = other as usize;
                    if passed[other] {
                        continue;
                    }
                    for axis in [Vector::x(), Vector::y(), Vector::z()] {
                        self.bodies[other].constrain(&mesh.nodes[node as usize], &axis);
                    }
                    if held(&self.bodies[other]) {
                        passed[other] = true;
                        waiting.push(other);
                    }
                }
            }
        }
    }
}
