//! Boundary condition of the middle of an edge between two constrained nodes.

use super::constraint::{Constraint, Holder};
use crate::mesh::VolumeMesh;
use crate::mesh::volume::BoundaryFace;

/// The smallest cosine between directions of the two ends that count as one direction, bent by the surface.
const SAME_DIRECTION: f64 = 0.7;

/// The middle of an edge is held along the directions in which both ends are held, each the mean of the
/// two ends' directions and values. Between nodes of one segment that is the rigid movement at the
/// midpoint; between sliding nodes of a curved wall the middle slides across the mean normal. `None` where
/// the ends have no direction in common.
pub fn between(node: u32, first: &Constraint, second: &Constraint) -> Option<Constraint> {
    if first.count() == 3 && second.count() == 3 {
        return Some(Constraint::at(node, (first.values() + second.values()) * 0.5));
    }
    let (fewer, more) =
        if first.count() <= second.count() { (first, second) } else { (second, first) };
    let mut constraint = Constraint::free(node);
    for held in 0..fewer.count() {
        let axis = fewer.axes().column(held).into_owned();
        let parts = more.axes().transpose() * axis;
        let parts = parts.map_with_location(|k, _, part| if k < more.count() { part } else { 0.0 });
        let length = parts.norm();
        if length < SAME_DIRECTION {
            continue;
        }
        let other = more.axes() * parts / length;
        let other_value = parts.dot(more.values()) / length;
        let sum = axis + other;
        constraint.add(&sum.normalize(), (fewer.values()[held] + other_value) / sum.norm());
    }
    (constraint.count() > 0).then_some(constraint)
}

/// The edges whose middles are held as their ends are: those of faces of the boundary all of whose nodes are constrained, and those
/// of cells all of whose nodes belong to one body, as those of bone that is part of the mesh. Each as its two nodes with the
/// places of their constraints; an edge may come several times.
pub fn held_edges(
    mesh: &VolumeMesh,
    boundary: &[BoundaryFace],
    constraints: &[Constraint],
) -> Vec<[(u32, usize); 2]> {
    let mut constraint_of = vec![None; mesh.nodes.len()];
    for (place, constraint) in constraints.iter().enumerate() {
        // Constraints of nodes in the middle of edges are their own.
        if let Some(own) = constraint_of.get_mut(constraint.node as usize) {
            *own = Some(place);
        }
    }
    let of_node = |node: u32| constraint_of[node as usize].map(|place| (node, place));
    let mut edges = Vec::new();
    for nodes in boundary.iter().map(BoundaryFace::nodes) {
        let held: Option<Vec<(u32, usize)>> = nodes.iter().map(|&node| of_node(node)).collect();
        let Some(held) = held else { continue };
        edges.extend((0..held.len()).map(|side| [held[side], held[(side + 1) % held.len()]]));
    }
    let bodies = bodies_of_nodes(mesh, constraints);
    for (shape, nodes) in mesh.cells.iter().filter(|(_, nodes)| body_of(&bodies, nodes).is_some()) {
        let ends = shape.edges().iter().map(|edge| edge.map(|corner| of_node(nodes[corner])));
        edges.extend(ends.filter_map(|[a, b]| Some([a?, b?])));
    }
    edges
}

/// For each node the body that it belongs to.
fn bodies_of_nodes(mesh: &VolumeMesh, constraints: &[Constraint]) -> Vec<Option<Holder>> {
    let mut bodies = vec![None; mesh.nodes.len()];
    for constraint in constraints {
        if let Some(own) = bodies.get_mut(constraint.node as usize) {
            *own = constraint.body();
        }
    }
    bodies
}

/// The body to which all of some nodes belong.
fn body_of(bodies: &[Option<Holder>], nodes: &[u32]) -> Option<Holder> {
    let first = bodies[*nodes.first()? as usize]?;
    nodes.iter().all(|&node| bodies[node as usize] == Some(first)).then_some(first)
}

/// For each cell whether all its nodes belong to one body: it is bone that is part of the mesh.
pub fn cells_of_bodies(mesh: &VolumeMesh, constraints: &[Constraint]) -> Vec<bool> {
    let bodies = bodies_of_nodes(mesh, constraints);
    mesh.cells.iter().map(|(_, nodes)| body_of(&bodies, nodes).is_some()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vector;

    fn sliding(node: u32, normal: Vector, value: f64) -> Constraint {
        let mut constraint = Constraint::free(node);
        constraint.add(&normal.normalize(), value);
        constraint
    }

    #[test]
    fn the_middle_of_a_wall_edge_slides_across_the_same_normal() {
        let normal = Vector::new(0.3, -0.5, 0.8);
        let middle = between(7, &sliding(0, normal, 1.0), &sliding(1, normal, 2.0)).unwrap();
        assert_eq!((middle.node, middle.count()), (7, 1));
        let displacement = middle.axes() * middle.values();
        assert!((displacement - normal.normalize() * 1.5).norm() < 1e-15);
    }

    #[test]
    fn between_a_fixed_and_a_sliding_node_the_middle_is_held_across_only() {
        let fixed = Constraint::at(0, Vector::new(1.0, 0.0, 4.0));
        let middle = between(2, &fixed, &sliding(1, Vector::z(), 2.0)).unwrap();
        assert_eq!(middle.count(), 1);
        assert!((middle.axes() * middle.values() - Vector::new(0.0, 0.0, 3.0)).norm() < 1e-15);
    }

    #[test]
    fn walls_that_meet_at_a_corner_leave_the_edge_across_it_free() {
        assert_eq!(between(2, &sliding(0, Vector::x(), 0.0), &sliding(1, Vector::y(), 0.0)), None);
    }
}
