//! Discretisation error of an answer at finite strain: the two-level step of `discretisation_error` at its last tangent.

use super::direction::Remaining;
use super::enriched::{Enriched, NodalPressures};
use super::newton_state::Rest;
use super::tissue::Tissue;
use crate::material::hyperelastic::Law;
use crate::mesh::Vector;
use crate::mesh::volume::BoundaryFace;
use crate::model::dofs::Constrained;
use crate::model::fem::assembly;
use crate::model::fem::discretisation_error::{
    DiscretisationError, DistributedLoads, TwoLevel, factor, tolerance,
};
use crate::model::problem::{LoadCase, ModelError};
use crate::progress::{Phase, Progress};

/// What a finer mesh would see of a problem.
pub struct FinerProblem<'a> {
    /// The same tissue as linear elements see it.
    pub tissue: assembly::Tissue<'a>,
    pub laws: &'a [Law],
    /// The faces of the mesh that belong to one cell only.
    pub boundary: &'a [BoundaryFace],
    pub loads: &'a DistributedLoads,
}

/// What the mesh cannot show of an answer, or why that is not known.
pub type MeshError = Result<DiscretisationError, NoMeshError>;

/// Why there is no estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoMeshError {
    #[error("the state that was found is not stable, and its tangent no matrix to solve with")]
    Unstable,
    #[error("the answer turns cells inside out, and no finer mesh is near to it")]
    Inverted,
    #[error("the tangent of the answer could not be solved with")]
    NotSolved,
}

impl FinerProblem<'_> {
    pub(super) fn of(
        &self,
        tissue: &Tissue,
        rest: &mut Rest,
        constrained: &Constrained,
        progress: &dyn Progress,
    ) -> Result<MeshError, ModelError> {
        progress.phase(Phase::Estimate);
        let Constrained { constraints, dof_map } = *constrained;
        let Rest { positions, pressures: values, directions, touching, .. } = rest;
        let mesh = self.tissue.mesh;
        let by_node = |row: &u32| positions[*row as usize];
        let nodes: Vec<Vector> = dof_map.ordering.place.iter().map(by_node).collect();
        let displacement: Vec<Vector> =
            nodes.iter().zip(&mesh.nodes).map(|(x, rest)| x - rest).collect();

        // 1. What the edge functions do to the equations of the corners; edges that press do not move across what they press on.
        let pressures = directions.pressures.as_ref();
        let deformed = tissue.at(positions, values, pressures);
        let pressed = NodalPressures { pressures, values };
        let constraints_and_contact = touching.as_ref().map(|touching| touching.held(constraints));
        let two_level = TwoLevel {
            tissue: &self.tissue,
            dof_map,
            boundary: self.boundary,
            constraints: constraints_and_contact.as_deref().unwrap_or(constraints),
            loads: self.loads,
            displacement: &displacement,
            cells: &Enriched::new(&self.tissue, self.laws, tissue, &deformed, &pressed),
            pressure_count: values.len(),
        };
        let (residual, squared_energy_norm) = two_level.at_corners()?;

        // 2. What that does to the corners, by the last tangent.
        let has_pressures = pressures.is_some();
        let unbalanced = residual.forces.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
        let case = LoadCase {
            held: vec![Vector::zeros(); constraints.len()],
            forces: residual.forces,
            ..LoadCase::default()
        };
        let left: Vec<f64> = residual.volumes.iter().map(|volume| -volume).collect();
        let relative = tolerance(self.tissue.materials, has_pressures);
        let remaining = Remaining {
            case: &case,
            volumes: &left,
            nodes: &nodes,
            displacement: &displacement,
            share: 1.0,
            relative,
            unbalanced,
            progress,
        };
        let mut touching = touching.clone();
        let found = directions.of(&deformed, constrained, &remaining, touching.as_mut())?;
        if !found.is_convex {
            return Ok(Err(NoMeshError::Unstable));
        }
        if !found.is_met {
            return Ok(Err(NoMeshError::NotSolved));
        }
        let place = dof_map.ordering.place.iter();
        let step: Vec<Vector> = place.map(|&row| found.positions[row as usize]).collect();
        let factor = factor(has_pressures) * two_level.share(&step, &case.forces)?;
        let missing = step.into_iter().map(|e| e * factor).collect();
        let iterations = found.iterations;
        Ok(Ok(DiscretisationError { missing, squared_energy_norm, iterations }))
    }
}
