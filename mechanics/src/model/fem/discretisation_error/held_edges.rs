//! Constrained edges of the boundary: those of faces all of whose nodes are constrained, as in `quadratic`.

use nalgebra::Matrix3;

use super::edges::Edges;
use crate::boundary::{Constraint, midpoint};
use crate::mesh::Vector;
use crate::mesh::volume::BoundaryFace;

/// The holds of the middles of held edges.
pub(super) struct HeldEdges {
    /// For each edge its place in `holds`, or `FREE`.
    of_edge: Vec<u32>,
    constraints: Vec<Constraint>,
}

const FREE: u32 = u32::MAX;

impl HeldEdges {
    pub fn new(
        faces: &[BoundaryFace],
        constraints: &[Constraint],
        nodes: usize,
        edges: &Edges,
    ) -> Self {
        let mut of_node = vec![FREE; nodes];
        for (place, constraint) in (0..).zip(constraints) {
            of_node[constraint.node as usize] = place;
        }
        let mut held = HeldEdges { of_edge: vec![FREE; edges.count()], constraints: Vec::new() };
        for face in faces {
            let nodes = face.nodes();
            let of_face: Option<Vec<&Constraint>> = nodes
                .iter()
                .map(|&node| constraints.get(of_node[node as usize] as usize))
                .collect();
            let Some(of_face) = of_face else { continue };
            for side in 0..nodes.len() {
                let next = (side + 1) % nodes.len();
                let Some(edge) = edges.between(nodes[side], nodes[next]) else { continue };
                let middle = midpoint::between(nodes[side], of_face[side], of_face[next]);
                held.constrain(edge, middle);
            }
        }
        held
    }

    fn constrain(&mut self, edge: usize, middle: Option<Constraint>) {
        if let (FREE, Some(middle)) = (self.of_edge[edge], middle) {
            self.of_edge[edge] = self.constraints.len() as u32;
            self.constraints.push(middle);
        }
    }

    /// D^-1 r along the axes of an edge that are free.
    pub fn step(&self, edge: usize, residual: &Vector, stiffness: &Matrix3<f64>) -> Vector {
        let Some(constraint) = self.constraints.get(self.of_edge[edge] as usize) else {
            return solved(stiffness, residual);
        };
        let axes = constraint.axes();
        let (mut d, mut r) = (axes.transpose() * stiffness * axes, axes.transpose() * residual);
        for k in 0..constraint.count() {
            d.fill_row(k, 0.0);
            d.fill_column(k, 0.0);
            d[(k, k)] = 1.0;
            r[k] = 0.0;
        }
        axes * solved(&d, &r)
    }
}

/// Zero where nothing resists.
fn solved(stiffness: &Matrix3<f64>, residual: &Vector) -> Vector {
    stiffness.cholesky().map_or_else(Vector::zeros, |factor| factor.solve(residual))
}
