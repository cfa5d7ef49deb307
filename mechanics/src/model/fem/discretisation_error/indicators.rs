//! Error indicators of cells for a goal functional: residuals of edges, weighted by the dual solution.
//!
//! A goal is a weighted mean J(v) = int w . v dA over a surface. With the answer z of its dual problem a(v, z) = J(v), which
//! has the same matrix, the functions of the edges change the goal by
//!   J(b) - a(b, z) = sum_e b_e . s_e,   s_e = J(phi_e) - a(phi_e, z),
//! and the cells around an edge share |b_e . s_e|. So an edge counts where the answer lacks something that the goal feels,
//! and where what the goal feels of it is not smooth.
//!
//! Source: Becker, Rannacher, An optimal control approach to a posteriori error estimation, Acta Numerica 10, 2001, section 4;
//! marking: Doerfler, A convergent adaptive algorithm for Poisson's equation, SIAM Journal on Numerical Analysis 33, 1996.

use super::cell::CellAnswer;
use super::edges::Edges;
use super::{Correction, Estimate, tolerance};
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::linear_system::{Residual, Solved};
use crate::model::problem::ModelError;
use crate::progress::{Phase, Progress};

/// A weighted mean of the displacement of a surface.
pub struct Goal<'a> {
    /// Nodes of the mesh.
    pub triangles: &'a [[u32; 3]],
    /// For each node of the mesh what a displacement there counts for, for each mm² around it.
    pub weights: &'a [Vector],
}

impl Goal<'_> {
    fn areas<'b>(&'b self, mesh: &'b VolumeMesh) -> impl Iterator<Item = ([u32; 3], f64)> + 'b {
        self.triangles.iter().map(|&nodes| {
            let [a, b, c] = nodes.map(|node| mesh.nodes[node as usize]);
            (nodes, (b - a).cross(&(c - a)).norm() * 0.5)
        })
    }

    /// J of the function of each node.
    fn of_nodes(&self, mesh: &VolumeMesh) -> Vec<Vector> {
        let mut of_nodes = vec![Vector::zeros(); mesh.nodes.len()];
        for (nodes, area) in self.areas(mesh) {
            for node in nodes {
                of_nodes[node as usize] += self.weights[node as usize] * (area / 3.0);
            }
        }
        of_nodes
    }

    /// Adds J of the function of each edge, a third of the area of a triangle.
    fn add_to(&self, mesh: &VolumeMesh, edges: &Edges, of_edges: &mut [Vector]) {
        for ([a, b, c], area) in self.areas(mesh) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let mean = (self.weights[from as usize] + self.weights[to as usize]) * 0.5;
                if let Some(edge) = edges.between(from, to) {
                    of_edges[edge] += mean * (area / 3.0);
                }
            }
        }
    }
}

impl Estimate<'_> {
    /// For each cell its share of what the mesh leaves out of a goal; never negative.
    pub fn indicators(
        &self,
        solved: &Solved,
        goal: &Goal,
        progress: &dyn Progress,
    ) -> Result<Vec<f64>, ModelError> {
        progress.phase(Phase::Estimate);
        let mesh = self.tissue.mesh;

        // 1. b of the answer.
        let cells = self.cells(self.answered(solved));
        let answer = self.two_level(&cells);
        let edges = answer.edges();
        let mut equations = answer.equations(&edges)?;
        let steps = answer.steps(&edges, &mut equations)?;

        // 2. s of the dual answer.
        let residual = Residual { forces: goal.of_nodes(mesh), volumes: Vec::new() };
        let relative = tolerance(self.tissue.materials, self.system.pressures.is_some());
        let dual = self.system.solve_for(&[residual], relative, progress)?.remove(0);
        let Correction { displacement, pressures, .. } = &dual;
        let cells = self.cells(CellAnswer { displacement, pressures, growth: &[] });
        let mut weights = self.two_level(&cells).equations(&edges)?.residual;
        goal.add_to(mesh, &edges, &mut weights);

        // 3. Shares.
        let mut sharing = vec![0_u32; edges.count()];
        let all = 0..mesh.cells.len();
        all.clone().for_each(|cell| {
            edges.of_cell(cell).numbers().for_each(|edge| sharing[edge] += 1);
        });
        let share =
            |edge: usize| steps[edge].dot(&weights[edge]).abs() / f64::from(sharing[edge].max(1));
        Ok(all.map(|cell| edges.of_cell(cell).numbers().map(share).sum()).collect())
    }
}

/// The fewest cells that together have so large a share of all indicators, ascending.
pub fn marked(indicators: &[f64], share: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..indicators.len()).collect();
    order.sort_by(|&a, &b| indicators[b].total_cmp(&indicators[a]).then(a.cmp(&b)));
    let wanted = share * indicators.iter().sum::<f64>();
    let mut sum = 0.0;
    let mut marked: Vec<usize> = order
        .into_iter()
        .take_while(|&cell| {
            let goes_on = sum < wanted;
            sum += indicators[cell];
            goes_on
        })
        .collect();
    marked.sort_unstable();
    marked
}
