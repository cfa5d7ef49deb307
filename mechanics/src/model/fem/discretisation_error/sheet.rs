//! The membrane in the equations of edges: its triangles with functions on their sides.
//!
//! A quadrilateral is cut along its diagonal, whose function stands for what the four edges around it make there: half of
//! each in its middle.

use std::collections::BTreeMap;

use super::edge_equations::{EdgeEquation, EdgeEquations};
use super::edges::Edges;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::membrane::Membrane;

/// The sides of triangles as edges of cells.
pub(super) struct Sheet<'a> {
    membrane: &'a Membrane,
    mesh: &'a VolumeMesh,
    edges: &'a Edges<'a>,
    /// For each diagonal the edges around it.
    around: BTreeMap<usize, Vec<usize>>,
}

/// int grad phi_ab of a side is this times V (g_a + g_b).
const MEAN: f64 = 4.0 / 3.0;

/// The corners of each side.
const SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The part of a diagonal that each edge around it makes.
const HALF: f64 = 0.5;

impl<'a> Sheet<'a> {
    /// `is_edge` tells edges of cells from other pairs of their nodes.
    pub fn new(
        membrane: &'a Membrane,
        mesh: &'a VolumeMesh,
        edges: &'a Edges<'a>,
        is_edge: impl Fn(usize) -> bool,
    ) -> Self {
        let mut around: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for nodes in &membrane.triangles {
            let sides = SIDES.map(|[a, b]| edges.between(nodes[a], nodes[b]));
            for diagonal in sides.into_iter().flatten().filter(|&side| !is_edge(side)) {
                let others = sides.into_iter().flatten().filter(|&other| other != diagonal);
                around.entry(diagonal).or_default().extend(others);
            }
        }
        Sheet { membrane, mesh, edges, around }
    }

    /// Adds what the sheet does to the equations of the edges.
    pub fn add_equations(&self, displacement: &[Vector], equations: &mut EdgeEquations) {
        for (triangle, nodes) in self.membrane.in_space(self.mesh) {
            let g = &triangle.gradients;
            for [a, b] in SIDES {
                let mean = (g[a] + g[b]) * MEAN;
                let moved = nodes.iter().zip(g);
                let residual = -moved
                    .map(|(&node, slope)| triangle.pair(&mean, slope) * displacement[node as usize])
                    .sum::<Vector>();
                let own = (triangle.pair(&g[a], &g[a]) + triangle.pair(&g[b], &g[b])) * 2.0;
                let mixed = triangle.pair(&g[a], &g[b]) + triangle.pair(&g[b], &g[a]);
                let stiffness = (own + mixed) * MEAN;
                for (edge, share) in self.shares([nodes[a], nodes[b]]) {
                    let (residual, stiffness) = (residual * share, stiffness * (share * share));
                    equations.add(edge, &EdgeEquation { residual, stiffness });
                }
            }
        }
    }

    /// Subtracts what coefficients of edges do to the nodes.
    pub fn subtract_forces(&self, steps: &[Vector], forces: &mut [Vector]) {
        for (triangle, nodes) in self.membrane.in_space(self.mesh) {
            let g = &triangle.gradients;
            for [a, b] in SIDES {
                let mean = (g[a] + g[b]) * MEAN;
                let shares = self.shares([nodes[a], nodes[b]]).into_iter();
                let b: Vector = shares.map(|(edge, share)| steps[edge] * share).sum();
                for (&node, slope) in nodes.iter().zip(g) {
                    forces[node as usize] -= triangle.pair(slope, &mean) * b;
                }
            }
        }
    }

    /// The edges that make a side, and the part of each.
    fn shares(&self, ends: [u32; 2]) -> Vec<(usize, f64)> {
        let Some(side) = self.edges.between(ends[0], ends[1]) else { return Vec::new() };
        match self.around.get(&side) {
            Some(edges) => edges.iter().map(|&edge| (edge, HALF)).collect(),
            None => vec![(side, 1.0)],
        }
    }
}
