//! Nodes in the middle of the edges of tetrahedra, with the boundary conditions and loads there.

use crate::boundary::{Constraint, midpoint};
use crate::element::tetrahedron10;
use crate::mesh::{Vector, VolumeMesh, Warning};
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::fem::strain::inverted_cells;
use crate::model::problem::{Equilibrium, LoadCase};
use crate::solver::element_connectivity::ElementConnectivity;
use nalgebra::Matrix3;
use rayon::prelude::*;

/// The middles of the edges of a mesh of tetrahedra, numbered after its nodes.
pub struct EdgeNodes {
    /// The two ends of each edge, the lower first; edges ascending.
    ends: Vec<[u32; 2]>,
    corners: usize,
}

impl EdgeNodes {
    pub fn new(mesh: &VolumeMesh) -> Self {
        let edges = mesh.cells.iter().flat_map(|(shape, nodes)| {
            shape.edges().iter().map(move |&[a, b]| sorted([nodes[a], nodes[b]]))
        });
        let mut ends: Vec<[u32; 2]> = edges.collect();
        ends.par_sort_unstable();
        ends.dedup();
        EdgeNodes { ends, corners: mesh.nodes.len() }
    }

    /// Nodes of the mesh and of its edges.
    pub fn node_count(&self) -> usize {
        self.corners + self.ends.len()
    }

    /// The node in the middle of an edge of the mesh.
    pub fn between(&self, a: u32, b: u32) -> u32 {
        let edge = self.ends.binary_search(&sorted([a, b]));
        (self.corners + edge.expect("both nodes belong to one cell of the mesh")) as u32
    }

    /// The positions of all nodes in mm.
    pub fn positions(&self, mesh: &VolumeMesh) -> Vec<Vector> {
        let middle = |[a, b]: &[u32; 2]| (mesh.nodes[*a as usize] + mesh.nodes[*b as usize]) * 0.5;
        mesh.nodes.iter().copied().chain(self.ends.iter().map(middle)).collect()
    }

    /// The ten nodes of a cell, corners first.
    pub fn of_cell(&self, mesh: &VolumeMesh, cell: usize) -> [u32; 10] {
        let corners = mesh.cells.nodes(cell);
        std::array::from_fn(|k| match k {
            0..4 => corners[k],
            _ => {
                let [a, b] = tetrahedron10::EDGES[k - 4];
                self.between(corners[a], corners[b])
            }
        })
    }

    /// The holds and, after them, those of edge nodes that have none of their own yet; with the two holds
    /// between which each of these lies.
    fn constraints(
        &self,
        mesh: &VolumeMesh,
        constraints: &[Constraint],
    ) -> (Vec<Constraint>, Vec<[usize; 2]>) {
        let mut is_held = vec![false; self.node_count()];
        constraints.iter().for_each(|constraint| is_held[constraint.node as usize] = true);
        let mut all = constraints.to_vec();
        let mut parents = Vec::new();
        for [(a, of_a), (b, of_b)] in
            midpoint::held_edges(mesh, &mesh.boundary_faces(), constraints)
        {
            let middle = self.between(a, b);
            if is_held[middle as usize] {
                continue;
            }
            let between = midpoint::between(middle, &constraints[of_a], &constraints[of_b]);
            if let Some(constraint) = between {
                is_held[middle as usize] = true;
                all.push(constraint);
                parents.push([of_a, of_b]);
            }
        }
        (all, parents)
    }
}

/// A problem with nodes in the middle of edges: they come after the nodes of the mesh, their holds after those that are given.
pub(super) struct WithEdges<'a> {
    given: &'a [Constraint],
    pub edges: EdgeNodes,
    pub constraints: Vec<Constraint>,
    /// The two holds between which each hold of an edge node lies.
    parents: Vec<[usize; 2]>,
    /// Of all nodes at rest, in mm.
    pub positions: Vec<Vector>,
    /// The ten nodes of each cell.
    pub cells: ElementConnectivity,
}

impl<'a> WithEdges<'a> {
    /// Of a mesh of tetrahedra; holds may name edge nodes themselves.
    pub fn new(mesh: &VolumeMesh, given: &'a [Constraint]) -> Self {
        let edges = EdgeNodes::new(mesh);
        let (constraints, parents) = edges.constraints(mesh, given);
        let mut cells = ElementConnectivity::default();
        (0..mesh.cells.len()).for_each(|cell| cells.push(edges.of_cell(mesh, cell)));
        WithEdges { given, constraints, parents, positions: edges.positions(mesh), cells, edges }
    }

    /// A load case with values for edge nodes too, whose forces may be left out.
    pub fn case(&self, case: &LoadCase) -> LoadCase {
        let mut forces = case.forces.clone();
        forces.resize(self.positions.len(), Vector::zeros());
        LoadCase { held: self.values(case), forces, ..LoadCase::default() }
    }

    /// The values of all holds: those that are given, and those of edge nodes between them.
    fn values(&self, case: &LoadCase) -> Vec<Vector> {
        let mut given = self.given.to_vec();
        for (constraint, values) in given.iter_mut().zip(&case.held) {
            constraint.set_values(values);
        }
        let of_edges = self.constraints[given.len()..].iter().zip(&self.parents);
        let middles = of_edges.filter_map(|(constraint, &[a, b])| {
            midpoint::between(constraint.node, &given[a], &given[b])
                .map(|constraint| *constraint.values())
        });
        given.iter().map(|constraint| *constraint.values()).chain(middles).collect()
    }

    /// A displacement of all nodes that turns cells inside out says so: at their corners, where nothing is integrated and a curved
    /// cell may fold, or as the tetrahedra with flat sides that files show. Cells without volume at rest are left out.
    pub fn inverted_cells(&self, mesh: &VolumeMesh, displacement: &[Vector]) -> Option<Warning> {
        let cells = (0..mesh.cells.len()).into_par_iter();
        let least = cells.map(|cell| {
            let Ok((_, of_barycentric)) = tetrahedron(mesh, cell) else { return f64::INFINITY };
            let u = self.edges.of_cell(mesh, cell).map(|node| displacement[node as usize]);
            let curved = |corner: usize| {
                let mut at = [0.0; 4];
                at[corner] = 1.0;
                determinant(&u, &tetrahedron10::gradients(&at, &of_barycentric))
            };
            (0..4).map(curved).fold(determinant(&u[..4], &of_barycentric), f64::min)
        });
        inverted_cells(&least.collect::<Vec<f64>>())
    }

    /// Leaves the reactions of the holds that are given: what an edge node's hold exerts counts half at each of its ends.
    pub fn gather_reactions(&self, equilibrium: &mut Equilibrium) {
        let newton = equilibrium.solver.newton.iter_mut();
        let steps = newton.flat_map(|newton| &mut newton.load_steps);
        let on_the_way = steps.map(|step| &mut step.reactions);
        for reactions in on_the_way.chain([&mut equilibrium.reactions]) {
            let of_edges = reactions.split_off(self.given.len());
            for (force, ends) in of_edges.into_iter().zip(&self.parents) {
                ends.iter().for_each(|&end| reactions[end] += force * 0.5);
            }
        }
    }
}

/// det F of displacements and the gradients of their shape functions.
fn determinant(displacement: &[Vector], gradients: &[Vector]) -> f64 {
    let pairs = displacement.iter().zip(gradients);
    pairs.fold(Matrix3::identity(), |f, (u, g)| f + u * g.transpose()).determinant()
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellShape;

    /// On a line a quadratic map turns round at an end that its middle node comes nearer to than a quarter.
    #[test]
    fn a_cell_that_folds_at_a_corner_beside_its_quadrature_points_says_so() {
        let mut mesh = VolumeMesh::default();
        mesh.nodes.extend([Vector::zeros(), Vector::x(), Vector::y(), Vector::z()]);
        mesh.cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
        let with = WithEdges::new(&mesh, &[]);
        let middle = with.edges.between(0, 1) as usize;
        let warned = |by: f64| {
            let mut displacement = vec![Vector::zeros(); with.positions.len()];
            displacement[middle].x = by;
            with.inverted_cells(&mesh, &displacement)
        };
        assert!(warned(-0.24).is_none());
        let warning = warned(-0.3).unwrap();
        assert_eq!(warning.code, "cells-inverted");
        // dx/dL at the corner is 4 (1/2 - 3/10) - 1.
        let (name, det_f) = *warning.numbers.last().unwrap();
        assert!(name == "smallest_det_f" && (det_f + 0.2).abs() < 1e-12, "{warning:?}");
    }
}
