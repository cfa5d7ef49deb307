//! Nonlinearity of an answer, node by node: the second-order term of the equilibrium at finite strain.
//!
//! u2 = -K0^-1 N2(u1, u1), with N2 of `model::fem::force_series`, the matrix and the hierarchy that u1 was solved with, and
//! nothing moved where it is held: a held node is already where a finite movement takes it. One evaluation of forces and
//! one loose solution (docs/estimates.md#nonlinearity has |u2| beside the true error, from .5 to 25 mm).
//! u1 + u2 is the answer to second order; what that leaves out is told by u3 = -K0^-1 [2 N2(u1, u2) + N3(u1, u1, u1)].

use std::collections::BTreeMap;

use super::method::Method;
use super::pressed_tissue::may_buckle;
use super::scene::Scene;
use super::skin::landmark_displacement;
use super::walls::rotation_beyond_second_order;
use crate::mesh::{Vector, Warning};
use crate::model::fem::force_series::{ForceSeries, Forces, LinearState};
use crate::model::fem::linear_system::{Correction, LinearSystem, Residual, Solved};
use crate::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::Progress;
use crate::solver::SolverError;

/// Relative residual of the solution of an estimate, and of a second order that is part of an answer. With a tenth an estimate on
/// distorted hexahedra says a fifth too little.
const LOOSE: f64 = 0.03;
const OF_ANSWER: f64 = 1e-3;

/// The first term that an answer leaves out, in mm: that of second order of a linear one.
#[derive(Clone, Debug, PartialEq)]
pub struct Nonlinearity {
    /// For each node of the mesh.
    pub left_out: Vec<Vector>,
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
    #[error("it is not estimated where tissue presses on what it touches")]
    Contact,
    #[error("the loose solution of the second order failed: {0}")]
    Failed(ModelError),
}

/// Linearisation error, or the reason why it is not known.
pub type Estimated = Result<Nonlinearity, NonlinearityUnknown>;

/// Why linear elements of a scene have no second order, whatever moves it.
pub fn without_second_order(scene: &Scene) -> Option<NonlinearityUnknown> {
    if scene.has_pulling_fibres() {
        return Some(NonlinearityUnknown::PullingFibres);
    }
    (!scene.is_first_order()).then_some(NonlinearityUnknown::Quadratic)
}

/// Why a method has no estimate.
pub(super) fn reason_for_none(scene: &Scene) -> Option<NonlinearityUnknown> {
    if !scene.settings.estimate {
        return Some(NonlinearityUnknown::NotAsked);
    }
    match scene.settings.method {
        Method::FemLinear
        | Method::MassTensorTransverse(MassTensorSettings { iterations: Iterations::Fast }) => {
            without_second_order(scene).or_else(|| {
                let turned = rotation_beyond_second_order(scene);
                turned.map(|segment| NonlinearityUnknown::TurnedWall { segment })
            })
        }
        Method::FemNonlinear | Method::MassTensorNonlinear => {
            Some(NonlinearityUnknown::FiniteStrain)
        }
        Method::MassSpring(_)
        | Method::MassTensor(_)
        | Method::MassTensorTransverse(_)
        | Method::VolumeSpline(_)
        | Method::ThicknessWarp(_) => Some(NonlinearityUnknown::OtherMethod),
    }
}

/// The estimate for an answer of linear elements, and with doubt a warning where its tissue may buckle.
pub(super) fn estimate(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    with_doubt: bool,
    progress: &dyn Progress,
) -> Result<(Estimated, Option<Warning>), ModelError> {
    let second = match second_order(scene, system, solved, progress) {
        Ok(second) => second,
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => return Err(stopped),
        Err(other) => return Ok((Err(NonlinearityUnknown::Failed(other)), None)),
    };
    let doubt = match with_doubt {
        true => {
            let displacement = sums(&solved.equilibrium.displacement, &second.displacement);
            let pressures = both_pressures(solved, &second);
            may_buckle(scene, system, (&displacement, &pressures), progress)?
        }
        false => None,
    };
    Ok((Ok(Nonlinearity::of(scene, second.displacement)), doubt))
}

/// The linear answer of a scene whatever its method, and what the second order adds to it, for each node; none of elements that
/// have no linear system.
pub(super) fn second_order_of(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<Option<[Vec<Vector>; 2]>, ModelError> {
    let Some(system) = scene.assemble(progress)? else { return Ok(None) };
    let solved = system.solve(&[scene.linear_load_case()?], progress)?.remove(0);
    let second = second_order(scene, &system, &solved, progress)?;
    Ok(Some([solved.equilibrium.displacement, second.displacement]))
}

/// The answer to second order, with the forces of its holds, and the third order.
pub(super) fn to_second_order(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<(Equilibrium, Estimated), ModelError> {
    let Solved { equilibrium: first, pressures } = solved;
    let forces = second_order_forces(scene, system, solved)?;
    let second = solution(system, &forces, OF_ANSWER, progress)?;
    let more = system.reactions(&second, &forces.nodes);
    let displacement = sums(&first.displacement, &second.displacement);
    let both = both_pressures(solved, &second);
    let (states, unknown) = scene.states_at_second_order(system, &displacement, &both);
    let equilibrium = Equilibrium {
        displacement,
        reactions: sums(&first.reactions, &more),
        solver: first.solver.clone(),
        states,
        warnings: first.warnings.iter().cloned().chain(unknown).collect(),
    };
    let moved = LinearState { displacement: &first.displacement, pressures };
    let again = LinearState { displacement: &second.displacement, pressures: &second.pressures };
    let forces = series(scene, system).third(moved, again)?;
    let third = match solution(system, &forces, LOOSE, progress) {
        Ok(third) => Ok(Nonlinearity::of(scene, third.displacement)),
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => return Err(stopped),
        Err(other) => Err(NonlinearityUnknown::Failed(other)),
    };
    Ok((equilibrium, third))
}

fn second_order(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<Correction, ModelError> {
    solution(system, &second_order_forces(scene, system, solved)?, LOOSE, progress)
}

fn series<'a>(scene: &'a Scene, system: &LinearSystem) -> ForceSeries<'a> {
    let pressures = system.pressures.as_ref().map(|pressures| &pressures.cells);
    ForceSeries::new(scene.tissue(), pressures).with_inner(&scene.distributed.inner)
}

fn second_order_forces(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
) -> Result<Forces, ModelError> {
    let Solved { equilibrium: Equilibrium { displacement, .. }, pressures } = solved;
    Ok(series(scene, system).second_along(LinearState { displacement, pressures })?)
}

/// -K0^-1 of forces.
fn solution(
    system: &LinearSystem,
    forces: &Forces,
    relative_residual: f64,
    progress: &dyn Progress,
) -> Result<Correction, ModelError> {
    let residual = Residual {
        forces: forces.nodes.iter().map(|force| -force).collect(),
        volumes: forces.volumes.iter().map(|volume| -volume).collect(),
    };
    let found = system.solve_for(&[residual], relative_residual, progress)?.remove(0);
    match found.displacement.iter().flatten().all(|value| value.is_finite()) {
        true => Ok(found),
        false => Err(SolverError::NotFinite.into()),
    }
}

fn both_pressures(solved: &Solved, second: &Correction) -> Vec<f64> {
    solved.pressures.iter().zip(&second.pressures).map(|(p, q)| p + q).collect()
}

fn sums(some: &[Vector], others: &[Vector]) -> Vec<Vector> {
    some.iter().zip(others).map(|(one, other)| one + other).collect()
}

impl Nonlinearity {
    fn of(scene: &Scene, left_out: Vec<Vector>) -> Self {
        let landmarks = landmark_displacement(&scene.mesh, &scene.landmarks, &left_out);
        let landmarks = landmarks.into_iter().map(|(name, (moved, _))| (name, moved)).collect();
        Nonlinearity { left_out, landmarks }
    }
}
