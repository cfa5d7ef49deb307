//! Constrained edges: those whose middles are held as their ends are (`midpoint::held_edges`), as in `quadratic`.

use nalgebra::Matrix3;

use super::edges::Edges;
use crate::boundary::{Constraint, midpoint};
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};

/// The holds of the middles of held edges.
pub(super) struct HeldEdges {
    /// For each edge its place in `holds`, or `FREE`.
    of_edge: Vec<u32>,
    constraints: Vec<Constraint>,
}

const FREE: u32 = u32::MAX;

impl HeldEdges {
    pub fn new(
        mesh: &VolumeMesh,
        boundary: &[BoundaryFace],
        constraints: &[Constraint],
        edges: &Edges,
    ) -> Self {
        let mut held = HeldEdges { of_edge: vec![FREE; edges.count()], constraints: Vec::new() };
        for [(a, of_a), (b, of_b)] in midpoint::held_edges(mesh, boundary, constraints) {
            let Some(edge) = edges.between(a, b) else { continue };
            held.constrain(edge, midpoint::between(a, &constraints[of_a], &constraints[of_b]));
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
