//! The rule of Chabanas, Luboz, Payan 2003, section 3.5.4, for comparison: corners with a Jacobian that is not positive
//! move along its gradient, within bounds, until every corner is positive. It proves nothing about the inside.

use super::bounds::Bounds;
use crate::mesh::jacobian::HEXAHEDRON_CORNERS;
use crate::mesh::{CellShape, Vector, VolumeMesh};

/// Iterations after which the rule has failed.
const MOST_ITERATIONS: usize = 1000;

/// Share of the step that would make a corner's Jacobian zero.
const SHARE: f64 = 0.3;

/// Applies the rule; the iterations, or `None` where corners stay bad.
pub fn repair_by_corners(mesh: &mut VolumeMesh, bounds: &Bounds) -> Option<usize> {
    let first = mesh.nodes.clone();
    for iteration in 0..MOST_ITERATIONS {
        let mut steps = vec![Vector::zeros(); first.len()];
        if !add_steps(mesh, &mut steps) {
            return Some(iteration);
        }
        for (node, step) in steps.iter().enumerate() {
            let moved = mesh.nodes[node] + step - first[node];
            let room = bounds.farthest[node];
            let length = moved.norm();
            let kept = if length > room { moved * (room / length) } else { moved };
            mesh.nodes[node] = first[node] + kept;
        }
    }
    None
}

/// For each bad corner of hexahedra a step of its nodes along the gradient; whether there was one.
fn add_steps(mesh: &VolumeMesh, steps: &mut [Vector]) -> bool {
    let mut is_bad = false;
    let hexahedra = mesh.cells.iter().filter(|(shape, _)| *shape == CellShape::Hex8);
    for (_, nodes) in hexahedra {
        for corner in HEXAHEDRON_CORNERS {
            let places = corner.map(|local| mesh.nodes[nodes[local] as usize]);
            let [a, b, c] = [1, 2, 3].map(|other| places[other] - places[0]);
            let jacobian = a.dot(&b.cross(&c));
            if jacobian > 0.0 {
                continue;
            }
            is_bad = true;
            let [ga, gb, gc] = [b.cross(&c), c.cross(&a), a.cross(&b)];
            let gradients = [-(ga + gb + gc), ga, gb, gc];
            let square: f64 = gradients.iter().map(Vector::norm_squared).sum();
            let size = jacobian.abs().max(1e-3 * a.norm() * b.norm() * c.norm());
            let length = SHARE * size / square.max(f64::MIN_POSITIVE);
            for (local, gradient) in corner.iter().zip(gradients) {
                steps[nodes[*local] as usize] += gradient * length;
            }
        }
    }
    is_bad
}
