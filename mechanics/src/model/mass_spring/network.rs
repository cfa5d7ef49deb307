//! Spring network: springs, boundary conditions and loads.

use super::springs::Springs;
use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::model::fem::assembly::Tissue;
use crate::model::problem::{LoadCase, ModelError};
use crate::solver::{SolveReport, SolverError};
use std::collections::BTreeMap;

/// The Poisson ratio of a network of springs, on average over directions.
pub const POISSON_RATIO: f64 = 0.25;

/// Parameters of this model.
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

/// Where the nodes came to rest, and how.
pub(super) struct SpringEquilibrium {
    pub(super) positions: Vec<Vector>,
    pub(super) solver: SolveReport,
}

impl SpringEquilibrium {
    pub(super) fn nothing(network: &Network, wanted: f64) -> Self {
        let solver = SolveReport::at_rest(network.unknowns(), wanted);
        SpringEquilibrium { positions: network.start.clone(), solver }
    }
}

/// Springs, what holds their nodes and what acts on them.
pub(super) struct Network<'a> {
    pub(super) springs: Springs,
    pub(super) rest: &'a [Vector],
    pub(super) constraints: &'a [Constraint],
    /// For each node its entry in `holds`.
    pub(super) constraint_of: BTreeMap<u32, usize>,
    /// For each node, in mN.
    pub(super) acting: &'a [Vector],
    /// Nodes at rest, held ones where they are held to.
    pub(super) start: Vec<Vector>,
    /// |f_D|: the forces on the free unknowns at the start, springs taken as linear. Residuals are reported as
    /// shares of it, as those of finite elements are.
    pub(super) scale: f64,
}

impl<'a> Network<'a> {
    pub(super) fn new(
        tissue: &Tissue<'a>,
        constraints: &'a [Constraint],
        case: &'a LoadCase,
    ) -> Result<Self, ModelError> {
        let springs = Springs::new(tissue)?;
        let rest = tissue.mesh.nodes.as_slice();
        let mut moved = vec![Vector::zeros(); rest.len()];
        for (constraint, values) in constraints.iter().zip(&case.held) {
            let held = (0..constraint.count()).map(|k| constraint.axes().column(k) * values[k]);
            moved[constraint.node as usize] = held.sum();
        }
        let start = rest.iter().zip(&moved).map(|(x, u)| x + u).collect();
        let constraint_of = constraints
            .iter()
            .enumerate()
            .map(|(entry, constraint)| (constraint.node, entry))
            .collect();
        let acting = case.forces.as_slice();
        let mut network =
            Network { springs, rest, constraints, constraint_of, acting, start, scale: 0.0 };
        let resistance = network.springs.linear_forces(rest, &moved);
        network.scale = length(&network.unbalanced(&resistance));
        match network.scale.is_finite() {
            true => Ok(network),
            false => Err(SolverError::NotFinite.into()),
        }
    }

    /// The part of a force that moves a node: nothing along its held axes, nor at nodes without a spring.
    pub(super) fn free_part(&self, node: usize, force: Vector) -> Vector {
        if self.springs.total_stiffness[node] == 0.0 {
            return Vector::zeros();
        }
        match self.constraint_of.get(&(node as u32)) {
            None => force,
            Some(&entry) => {
                let constraint = &self.constraints[entry];
                let held =
                    (0..constraint.count()).map(|k| constraint.axes().column(k).into_owned());
                held.fold(force, |rest, axis| rest - axis * axis.dot(&force))
            }
        }
    }

    /// Residual forces of the free unknowns, in mN.
    pub(super) fn unbalanced(&self, resistance: &[Vector]) -> Vec<Vector> {
        let forces = self.acting.iter().zip(resistance).enumerate();
        forces.map(|(node, (acting, resisting))| self.free_part(node, acting - resisting)).collect()
    }

    /// Reaction force of each constraint, in mN.
    pub(super) fn reactions(&self, resistance: &[Vector]) -> Vec<Vector> {
        let reaction = |constraint: &Constraint| {
            let node = constraint.node as usize;
            let force = resistance[node] - self.acting[node];
            let along =
                |k: usize| constraint.axes().column(k) * constraint.axes().column(k).dot(&force);
            (0..constraint.count()).map(along).sum()
        };
        self.constraints.iter().map(reaction).collect()
    }

    pub(super) fn unknowns(&self) -> usize {
        let nodes = self.springs.total_stiffness.iter().filter(|k| **k > 0.0).count();
        let is_sprung =
            |constraint: &&Constraint| self.springs.total_stiffness[constraint.node as usize] > 0.0;
        let held: usize = self.constraints.iter().filter(is_sprung).map(Constraint::count).sum();
        3 * nodes - held
    }
}

/// The Euclidean norm over all nodes.
pub(super) fn length(vectors: &[Vector]) -> f64 {
    vectors.iter().map(Vector::norm_squared).sum::<f64>().sqrt()
}
