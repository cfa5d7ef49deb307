//! Equilibrium node by node (Teschner, Girod, Girod, Direct computation of nonlinear soft-tissue deformation, Vision,
//! Modeling and Visualization, 2000; docs/methods.md#mass-springs).
//!
//! p_i <- sum_j k_ij (p_j - L_ij n_ij) / sum_j k_ij,  n_ij = (p_j - p_i) / |p_j - p_i|, plus f_i / sum_j k_ij:
//! where the springs of the node would have it if they kept their directions. Each node sees the newest
//! places of the others. As |d| >= d . n, the springs cost no more than this step takes them to cost,
//! so that no step raises the energy: it cannot diverge, and it is slow.

use super::network::{MassSpringSettings, Network, SpringEquilibrium, length};
use super::springs::Spring;
use crate::mesh::Vector;
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::rows::{Rows, Sorting};
use crate::solver::{SolveReport, SolverError, tell};

pub(super) fn solve(
    network: &Network,
    wanted: f64,
    settings: &MassSpringSettings,
    progress: &dyn Progress,
) -> Result<SpringEquilibrium, ModelError> {
    let around = NodeSprings::new(network);
    let mut positions = network.start.clone();
    let mut history = Vec::new();
    let mut residual = 1.0;
    for iteration in 1..=settings.most_iterations {
        residual = around.sweep(network, &mut positions) / network.scale;
        if residual <= wanted {
            let resistance = network.springs.forces(&positions);
            residual = length(&network.unbalanced(&resistance)) / network.scale;
        }
        history.push(residual);
        tell(progress, iteration, residual, wanted)?;
        if residual <= wanted {
            let solver = SolveReport {
                method: "direct_iteration",
                preconditioner: "node_stiffness",
                why: "residuals are those that a sweep meets on its way, the last one that of the answer"
                    .to_owned(),
                unknowns: network.unknowns(),
                iterations: iteration,
                relative_residual: residual,
                wanted_residual: wanted,
                history,
                steps: 1,
                newton: None,
            };
            return Ok(SpringEquilibrium { positions, solver });
        }
    }
    let iterations = settings.most_iterations;
    Err(SolverError::NotConverged { iterations, residual, wanted, history }.into())
}

/// The springs of each node, side by side, each seen from that node: a sweep reads them in one stream.
struct NodeSprings(Rows<Spring>);

impl NodeSprings {
    fn new(network: &Network) -> Self {
        let springs = &network.springs.springs;
        let mut lengths = vec![0; network.rest.len()];
        springs.iter().flat_map(|spring| spring.nodes).for_each(|node| lengths[node as usize] += 1);
        let Some(&any) = springs.first() else {
            return NodeSprings(Rows::of_lengths(&lengths, Vec::new()));
        };
        let mut sorting = Sorting::new(&lengths, any);
        for spring in springs {
            let [i, j] = spring.nodes;
            sorting.put(i as usize, *spring);
            sorting.put(j as usize, Spring { nodes: [j, i], ..*spring });
        }
        NodeSprings(sorting.finish())
    }

    /// Moves every node once; returns the norm of the forces that it met.
    fn sweep(&self, network: &Network, positions: &mut [Vector]) -> f64 {
        let mut squared = 0.0;
        for node in 0..positions.len() {
            let mut force = network.acting[node];
            for spring in self.0.row(node) {
                let (l, n) = spring.span(positions);
                force += n * (spring.stiffness * (l - spring.length));
            }
            let force = network.free_part(node, force);
            squared += force.norm_squared();
            if force != Vector::zeros() {
                positions[node] += force / network.springs.total_stiffness[node];
            }
        }
        squared.sqrt()
    }
}
