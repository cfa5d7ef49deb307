//! The mass-spring model: nodes joined by springs along the edges of tetrahedra (METHODS A5; paper 002,
//! section 1.4.1, eq. 2-4).
//!
//! At rest the forces of the springs, for whatever turn and stretch, balance those that act:
//! sum_j k_ij (|d| - L) d / |d| + f_i = 0, d = p_j - p_i. There are no masses: only rest is asked for.
//! The springs know lengths and not volumes. On average they are an elastic body of bulk modulus 2 E / 3 and of
//! equal C1122 and C1212, whatever the mesh: a Poisson ratio of 1/4, which no choice of E changes. Nor does
//! a spring know on which side of a face its node is: a tetrahedron that is pushed through itself stays so.

mod direct;
mod newton;
mod springs;

use std::collections::BTreeMap;

pub use springs::{Spring, Springs};

use super::problem::{Convergence, Equilibrium, LoadCase, ModelError, Observer};
use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::displacement::{Problem, check_finite};
use crate::solver::SolverError;

/// The Poisson ratio of a network of springs, on average over directions.
pub const POISSON_RATIO: f64 = 0.25;

/// What only this model has to be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassSpringSettings {
    pub search: Search,
    pub most_iterations: usize,
}

/// How rest is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// Newton's method with a line search on the energy; each step solves a sparse system.
    #[default]
    Newton,
    /// Node by node, each to where its own springs would have it.
    Direct,
}

/// Solves a load case for rest.
pub fn solve(
    problem: &Problem,
    settings: &MassSpringSettings,
    case: &LoadCase,
    observer: &dyn Observer,
) -> Result<Equilibrium, ModelError> {
    observer.assembling();
    let network = Network::new(&problem.tissue, problem.holds, case)?;
    observer.solving();
    let wanted = problem.tolerance.relative_residual;
    let found = match (network.scale > 0.0, settings.search) {
        (false, _) => Found::nothing(&network),
        (true, Search::Newton) => newton::solve(&network, problem, settings, observer)?,
        (true, Search::Direct) => direct::solve(&network, wanted, settings, observer)?,
    };
    let forces = network.springs.forces(&found.positions);
    let displacement = found.positions.iter().zip(network.rest).map(|(p, x)| p - x).collect();
    let equilibrium = Equilibrium {
        displacement,
        reactions: network.reactions(&forces),
        convergence: found.convergence,
        unknowns: network.unknowns(),
        warnings: Vec::new(),
    };
    check_finite(std::slice::from_ref(&equilibrium))?;
    Ok(equilibrium)
}

/// Where the nodes came to rest, and how.
struct Found {
    positions: Vec<Vector>,
    convergence: Convergence,
}

impl Found {
    fn nothing(network: &Network) -> Self {
        let convergence = Convergence {
            method: "none",
            preconditioner: "none",
            why: "nothing moves and nothing acts".to_owned(),
            iterations: 0,
            relative_residual: 0.0,
            history: Vec::new(),
            steps: 1,
        };
        Found { positions: network.start.clone(), convergence }
    }
}

/// Springs, what holds their nodes and what acts on them.
struct Network<'a> {
    springs: Springs,
    rest: &'a [Vector],
    holds: &'a [Hold],
    /// For each node its entry in `holds`.
    hold_of: BTreeMap<u32, usize>,
    /// For each node, in mN.
    acting: &'a [Vector],
    /// Nodes at rest, held ones where they are held to.
    start: Vec<Vector>,
    /// |f_D|: the forces on the free unknowns at the start, springs taken as linear. Residuals are told as
    /// shares of it, as those of finite elements are.
    scale: f64,
}

impl<'a> Network<'a> {
    fn new(tissue: &Tissue<'a>, holds: &'a [Hold], case: &'a LoadCase) -> Result<Self, ModelError> {
        let springs = Springs::new(tissue)?;
        let rest = tissue.mesh.nodes.as_slice();
        let mut moved = vec![Vector::zeros(); rest.len()];
        for (hold, values) in holds.iter().zip(&case.held) {
            let held = (0..hold.count()).map(|k| hold.axes().column(k) * values[k]);
            moved[hold.node as usize] = held.sum();
        }
        let start = rest.iter().zip(&moved).map(|(x, u)| x + u).collect();
        let hold_of = holds.iter().enumerate().map(|(entry, hold)| (hold.node, entry)).collect();
        let acting = case.forces.as_slice();
        let mut network = Network { springs, rest, holds, hold_of, acting, start, scale: 0.0 };
        let resistance = network.springs.linear_forces(rest, &moved);
        network.scale = length(&network.unbalanced(&resistance));
        match network.scale.is_finite() {
            true => Ok(network),
            false => Err(SolverError::NotFinite.into()),
        }
    }

    /// The part of a force that moves a node: nothing along its held axes, nor at nodes without a spring.
    fn free_part(&self, node: usize, force: Vector) -> Vector {
        if self.springs.total_stiffness[node] == 0.0 {
            return Vector::zeros();
        }
        match self.hold_of.get(&(node as u32)) {
            None => force,
            Some(&entry) => {
                let hold = &self.holds[entry];
                let held = (0..hold.count()).map(|k| hold.axes().column(k).into_owned());
                held.fold(force, |rest, axis| rest - axis * axis.dot(&force))
            }
        }
    }

    /// What acts less what resists, where nodes are free to follow, in mN.
    fn unbalanced(&self, resistance: &[Vector]) -> Vec<Vector> {
        let forces = self.acting.iter().zip(resistance).enumerate();
        forces.map(|(node, (acting, resisting))| self.free_part(node, acting - resisting)).collect()
    }

    /// What each hold exerts, in mN.
    fn reactions(&self, resistance: &[Vector]) -> Vec<Vector> {
        let reaction = |hold: &Hold| {
            let node = hold.node as usize;
            let force = resistance[node] - self.acting[node];
            let along = |k: usize| hold.axes().column(k) * hold.axes().column(k).dot(&force);
            (0..hold.count()).map(along).sum()
        };
        self.holds.iter().map(reaction).collect()
    }

    fn unknowns(&self) -> usize {
        let nodes = self.springs.total_stiffness.iter().filter(|k| **k > 0.0).count();
        let is_sprung = |hold: &&Hold| self.springs.total_stiffness[hold.node as usize] > 0.0;
        let held: usize = self.holds.iter().filter(is_sprung).map(Hold::count).sum();
        3 * nodes - held
    }
}

/// The Euclidean norm over all nodes.
fn length(vectors: &[Vector]) -> f64 {
    vectors.iter().map(Vector::norm_squared).sum::<f64>().sqrt()
}
