//! Stability of equilibria: whether a tangent is positive definite, and whether tissue buckles under the stress of a linear answer.
//!
//! Under a stress sigma = s + p 1, tr s = 0, tissue at small strain resists a further displacement v by K and by the stiffness of
//! that stress (linearised buckling: Bathe, Finite Element Procedures, 1996, section 6.8.2)
//!   int s : (grad v^T grad v) - p tr(grad v grad v) dV,
//! in which the pressure stands as in the tangent of neo-Hookean tissue about rest (its log-volume term): what is held all around
//! does not buckle under pressure alone, and a strut under s + p buckles at Euler's load. The initial displacement is left out.
//! Stress is taken as a mean over each cell; at corners of bones it grows without limit as cells shrink, so no cell counts as pressed
//! by more than `MOST` of its shear modulus, with which no cell is unstable by itself (that takes 1).

use nalgebra::Matrix3;

use super::assembly::Tissue;
use super::displacement_pressure::shear_stiffness;
use super::inner_stress::{slopes, volume};
use super::linear_system::LinearSystem;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;
use crate::model::problem::{InvertedCell, LoadCase, ModelError};
use crate::progress::{Inner, Progress};
use crate::solver::conjugate_gradient::{self, StoppingCriterion};
use crate::solver::mixed_system::{Coupling, MixedSystem};
use crate::solver::pressed_curvature;
use crate::solver::{Block, Solver, SolverError, System};

/// Iterations after which the definiteness of a matrix without pressures is not known.
const MOST_PLAIN: usize = 200;

/// When a matrix is known to be positive definite.
#[derive(Clone, Copy)]
pub(super) struct Certainty {
    /// A load of no pattern has in the mean one part in the root of the unknowns along any one direction, and no iteration makes
    /// that smaller where the matrix has no positive curvature along it, unless it meets that. It is known at this share of that part.
    share: f64,
    /// With pressures, whose bulk modulus makes what is left of the tangent stiff, in so many iterations.
    most_stiff: usize,
}

impl Certainty {
    /// Of an equilibrium that is said to be stable.
    pub const OF_ANSWER: Certainty = Certainty { share: 0.01, most_stiff: 400 };
    /// Of a doubt, which is to cost less than the answer.
    const OF_DOUBT: Certainty = Certainty { share: 0.1, most_stiff: 60 };
}

/// The largest pressure along an axis that counts, as a share of the shear modulus.
const MOST: f64 = 0.7;

/// The largest tension along an axis, and the largest mean stress, as multiples of it: beyond them stress is that of no tissue.
const MOST_TENSION: f64 = 1e3;

/// A matrix with the pressures that answer to displacements, where there are some, and what approximates its inverse: the solver
/// may be that of a matrix near by.
pub(super) struct Tangent<'a> {
    pub constrained: &'a Constrained<'a>,
    pub system: &'a System,
    pub coupling: Option<&'a Coupling>,
    pub solver: &'a Solver,
    pub certainty: Certainty,
}

impl Tangent<'_> {
    /// Whether it is positive definite along all that iterations meet on the way to a load of no pattern; none where they end
    /// before they meet it.
    pub fn is_positive_definite(
        &self,
        progress: &dyn Progress,
    ) -> Result<Option<bool>, SolverError> {
        let Tangent { constrained, system, coupling, solver, certainty } = *self;
        let inner = Inner(progress);
        let load = constrained.known(&without_pattern(constrained)).right_hand_side(system);
        let relative_residual = certainty.share / (load.as_flattened().len().max(1) as f64).sqrt();
        let criterion = StoppingCriterion { relative_residual, most_iterations: MOST_PLAIN };
        let multigrid = solver.hierarchy(system, progress)?;
        let alone = conjugate_gradient::direction(system, multigrid, &load, criterion, &inner)?;
        // Pressures can only make it stiffer, by B^T C^-1 B.
        let is_known = alone.is_convex && alone.iterations < MOST_PLAIN;
        match coupling {
            _ if is_known => Ok(Some(true)),
            None => Ok((!alone.is_convex).then_some(false)),
            Some(coupling) => {
                let criterion =
                    StoppingCriterion { most_iterations: certainty.most_stiff, ..criterion };
                let mixed = MixedSystem { stiffness: system, coupling, solver };
                pressed_curvature::is_positive_definite(&mixed, &load, criterion, &inner)
            }
        }
    }
}

/// A load of no pattern on nodes of which nothing moves.
fn without_pattern(constrained: &Constrained) -> LoadCase {
    // Multiples of the golden ratio, each less its whole part: as even and as patternless as random numbers.
    let mut number = 0.5;
    let mut next = || {
        number = (number + 0.618_033_988_749_895) % 1.0;
        number - 0.5
    };
    let nodes = 0..constrained.dof_map.ordering.place.len();
    LoadCase {
        held: vec![Vector::zeros(); constrained.constraints.len()],
        forces: nodes.map(|_| Vector::new(next(), next(), next())).collect(),
        ..LoadCase::default()
    }
}

impl LinearSystem<'_> {
    /// Whether tissue of this system is stable under a stress, in kPa for each cell; none where that is not known.
    pub fn is_stable_under(
        &self,
        tissue: &Tissue,
        stress: &(dyn Fn(usize) -> Matrix3<f64> + Sync),
        progress: &dyn Progress,
    ) -> Result<Option<bool>, ModelError> {
        let dof_map = &self.dof_map;
        let matrix = match &self.pressures {
            Some(_) => shear_stiffness(tissue, dof_map, progress)?,
            None => tissue.assemble(dof_map, progress)?,
        };
        let mut matrix = matrix.ok_or(SolverError::Stopped)?;
        let elements: Vec<usize> = (0..dof_map.ordering.element_order.len()).collect();
        let finished = dof_map.add_cells(&mut matrix, &elements, progress, |cell| {
            stress_stiffness(tissue, cell, &stress(cell))
        })?;
        if !finished {
            return Err(SolverError::Stopped.into());
        }
        let constrained = &self.constrained();
        let system = &constrained.system(matrix, &tissue.mesh.nodes);
        let coupling = self.pressures.as_ref().map(|own| &own.coupling);
        let certainty = Certainty::OF_DOUBT;
        let tangent = Tangent { constrained, system, coupling, solver: self.solver(), certainty };
        Ok(tangent.is_positive_definite(progress)?)
    }
}

/// The blocks of a cell by the stress in it, row by row, in kPa mm.
fn stress_stiffness(
    tissue: &Tissue,
    cell: usize,
    stress: &Matrix3<f64>,
) -> Result<Vec<Block>, InvertedCell> {
    let slopes = slopes(tissue.mesh, cell, None)?;
    let volume = volume(tissue.mesh, cell)?;
    let mu = tissue.tensor(cell).mu;
    let mean = stress.trace() / 3.0;
    let mut axes = (stress - Matrix3::from_diagonal_element(mean)).symmetric_eigen();
    axes.eigenvalues.apply(|along| *along = along.clamp(-MOST * mu, MOST_TENSION * mu));
    let pressure = mean.clamp(-MOST_TENSION * mu, MOST_TENSION * mu);
    let shear = axes.recompose();
    let mut blocks = Vec::with_capacity(slopes.len() * slopes.len());
    for j in slopes.iter().map(|slope| &slope.integral) {
        for k in slopes.iter().map(|slope| &slope.integral) {
            let block =
                Matrix3::from_diagonal_element(j.dot(&(shear * k))) - k * j.transpose() * pressure;
            let block = block / volume;
            blocks.push(std::array::from_fn(|row| {
                std::array::from_fn(|column| block[(row, column)])
            }));
        }
    }
    Ok(blocks)
}
