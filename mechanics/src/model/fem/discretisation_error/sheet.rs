//! The membrane in the equations of edges: its triangles with functions on their sides.
//!
//! A quadrilateral is cut along its diagonal, whose function stands for what the four edges around it make there: half of
//! each in its middle.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::edge_equations::{EdgeEquation, EdgeEquations};
use super::edges::Edges;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::membrane::{Membrane, Triangle};
use crate::model::fem::stretched_membrane::Stretched;

/// The sides of triangles as edges of cells.
pub(super) struct Sheet<'a> {
    membrane: &'a Membrane,
    mesh: &'a VolumeMesh,
    moved: SheetState<'a>,
    edges: &'a Edges<'a>,
    /// For each diagonal the edges around it.
    around: BTreeMap<usize, Vec<usize>>,
}

/// An answer.
#[derive(Clone, Copy)]
pub(super) struct SheetState<'a> {
    /// Of the nodes, in mm.
    pub displacement: &'a [Vector],
    /// Whether it is one of finite strain.
    pub is_finite: bool,
}

/// A triangle of the sheet as an answer has it.
struct Part<'a> {
    triangle: &'a Triangle,
    moved: [Vector; 3],
    /// At finite strain.
    stretched: Option<Stretched<'a>>,
}

impl Part<'_> {
    /// The stiffness between two gradients.
    fn pair(&self, gj: &Vector, gk: &Vector) -> Matrix3<f64> {
        match &self.stretched {
            None => self.triangle.pair(gj, gk),
            Some(stretched) => stretched.pair(gj, gk),
        }
    }

    /// The internal force at a function of this gradient.
    fn force(&self, g: &Vector) -> Vector {
        match &self.stretched {
            None => {
                let slopes = self.moved.iter().zip(&self.triangle.gradients);
                slopes.map(|(moved, slope)| self.triangle.pair(g, slope) * moved).sum()
            }
            Some(stretched) => stretched.force(g),
        }
    }
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
        (membrane, mesh): (&'a Membrane, &'a VolumeMesh),
        moved: SheetState<'a>,
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
        Sheet { membrane, mesh, moved, edges, around }
    }

    /// Adds what the sheet does to the equations of the edges.
    pub fn add_equations(&self, equations: &mut EdgeEquations) {
        for (triangle, nodes) in self.membrane.in_space(self.mesh) {
            let (part, g) = (self.part(&triangle, nodes), &triangle.gradients);
            for [a, b] in SIDES {
                let residual = -part.force(&((g[a] + g[b]) * MEAN));
                let own = (part.pair(&g[a], &g[a]) + part.pair(&g[b], &g[b])) * 2.0;
                let mixed = part.pair(&g[a], &g[b]) + part.pair(&g[b], &g[a]);
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
            let (part, g) = (self.part(&triangle, nodes), &triangle.gradients);
            for [a, b] in SIDES {
                let mean = (g[a] + g[b]) * MEAN;
                let shares = self.shares([nodes[a], nodes[b]]).into_iter();
                let b: Vector = shares.map(|(edge, share)| steps[edge] * share).sum();
                for (&node, slope) in nodes.iter().zip(g) {
                    forces[node as usize] -= part.pair(slope, &mean) * b;
                }
            }
        }
    }

    fn part<'b>(&self, triangle: &'b Triangle, nodes: [u32; 3]) -> Part<'b> {
        let moved = nodes.map(|node| self.moved.displacement[node as usize]);
        let corners = std::array::from_fn(|k| self.mesh.nodes[nodes[k] as usize] + moved[k]);
        let stretched = self.moved.is_finite.then(|| triangle.at(&corners));
        Part { triangle, moved, stretched }
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
