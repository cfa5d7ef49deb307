//! What linear elasticity leaves out of an answer, node by node: the second-order term of the equilibrium at finite strain.
//!
//! u2 = -K0^-1 N2(u1, u1), with N2 of `model::fem::force_series`, the matrix and the hierarchy that u1 was solved with, and
//! nothing moved where it is held: a held node is already where a finite movement takes it. One evaluation of forces and
//! one loose solution (NONLINEAR, sections 4 and 7: |u2| is .96 to 1.16 of the true error from .5 to 27 mm).
//! u1 + u2 is the answer to second order.

use std::collections::BTreeMap;

use super::method::Method;
use super::scene::Scene;
use super::skin::landmark_displacement;
use super::walls::turned_at_second_order;
use crate::material::LinearElastic;
use crate::mesh::Vector;
use crate::model::fem::force_series::{ForceSeries, Moved};
use crate::model::fem::linear_system::{LinearSystem, Residual, Solved};
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::Progress;
use crate::solver::SolverError;

/// Relative residual of the solution of an estimate.
const LOOSE: f64 = 0.1;

/// The second-order term of an answer, in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Nonlinearity {
    /// For each node of the mesh.
    pub second_order: Vec<Vector>,
    pub landmarks: BTreeMap<String, Vector>,
}

/// Why nothing is estimated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NonlinearityUnknown {
    #[error("it was not asked for")]
    NotAsked,
    #[error(
        "the answer is one of finite strain, which leaves nothing out that this could estimate"
    )]
    FiniteStrain,
    #[error("this method has no linear finite elements of which a second order is known")]
    OtherMethod,
    #[error("no second order is known of quadratic tetrahedra")]
    Quadratic,
    #[error("no second order is known of fibres that only pull: they are not smooth at rest")]
    PullingFibres,
    #[error(
        "a wall turns with segment {segment:?}, and small strain holds its nodes across the wall as it lay before"
    )]
    TurnedWall { segment: String },
    #[error("the loose solution of the second order failed: {0}")]
    Failed(ModelError),
}

/// What is left out, or why that is not known.
pub type Estimated = Result<Nonlinearity, NonlinearityUnknown>;

/// Why a method has no estimate.
pub(super) fn reason_for_none(scene: &Scene) -> Option<NonlinearityUnknown> {
    if !scene.settings.estimate {
        return Some(NonlinearityUnknown::NotAsked);
    }
    match scene.settings.method {
        Method::FemLinear | Method::MassTensorTransverse => {
            let pulls = scene.materials.iter().any(LinearElastic::has_pulling_fibres);
            if pulls {
                return Some(NonlinearityUnknown::PullingFibres);
            }
            let turned = turned_at_second_order(scene);
            turned.map(|segment| NonlinearityUnknown::TurnedWall { segment })
        }
        Method::FemNonlinear | Method::MassTensorNonlinear => {
            Some(NonlinearityUnknown::FiniteStrain)
        }
        Method::MassSpring(_)
        | Method::MassTensor(_)
        | Method::VolumeSpline(_)
        | Method::ThicknessWarp(_) => Some(NonlinearityUnknown::OtherMethod),
    }
}

/// The estimate for an answer of linear elements.
pub(super) fn estimate(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<Estimated, ModelError> {
    match second_order(scene, system, solved, progress) {
        Ok(second_order) => {
            let landmarks = landmark_displacement(&scene.mesh, &scene.landmarks, &second_order);
            let landmarks = landmarks.into_iter().map(|(name, (moved, _))| (name, moved)).collect();
            Ok(Ok(Nonlinearity { second_order, landmarks }))
        }
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => Err(stopped),
        Err(other) => Ok(Err(NonlinearityUnknown::Failed(other))),
    }
}

fn second_order(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<Vec<Vector>, ModelError> {
    let pressures = system.pressures.as_ref().map(|pressures| &pressures.cells);
    let series = ForceSeries::new(scene.tissue(), pressures);
    let Solved { equilibrium: Equilibrium { displacement, .. }, pressures } = solved;
    let forces = series.second(&[Moved { displacement, pressures }], &[[0, 0]])?.remove(0);
    let residual = Residual {
        forces: forces.nodes.iter().map(|force| -force).collect(),
        volumes: forces.volumes.iter().map(|volume| -volume).collect(),
    };
    let mut corrections = system.solve_for(&[residual], LOOSE, progress)?;
    let second_order = corrections.remove(0).displacement;
    match second_order.iter().flatten().all(|value| value.is_finite()) {
        true => Ok(second_order),
        false => Err(SolverError::NotFinite.into()),
    }
}
