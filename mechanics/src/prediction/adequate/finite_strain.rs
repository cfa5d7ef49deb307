//! The answer at finite strain that a search for the cheapest adequate model tries.

use super::accepted::Accepted;
use super::objection::Objection;
use crate::mesh::Vector;
use crate::model::fem::finite_strain::Advance;
use crate::model::problem::ModelError;
use crate::prediction::answer::{self, Answer, LinearAnswer};
use crate::prediction::branch::Branches;
use crate::prediction::case::{Case, Plan, Settings};
use crate::prediction::fibres::FIBRES_IGNORED;
use crate::prediction::method::Method;
use crate::prediction::problem::NoScene;
use crate::prediction::scene::Scene;
use crate::progress::{Progress, StopQuery};
use crate::solver::SolverError;

/// What speaks against a state that the second order does not lead to; `mean` is the mean length of displacements over the skin, in mm.
pub(super) fn another_branch(
    linear: &LinearAnswer,
    found: &Answer,
    accepted: &Accepted,
    mean: impl Fn(&[Vector]) -> f64,
) -> Option<Objection> {
    let newton = found.equilibrium.solver.newton.as_ref();
    if newton.is_some_and(|newton| newton.is_stable == Some(false)) {
        // That speaks against it already.
        return None;
    }
    let branches = Branches {
        linear: &linear.equilibrium().displacement,
        second_order: &linear.nonlinearity.as_ref().ok()?.left_out,
        found: &found.equilibrium.displacement,
    };
    let warning = branches.another(accepted.skin_mm, 1.0, mean)?;
    Some(Objection { warning, is_of_model: false })
}

/// Why there is none.
pub(super) enum NoAnswer {
    /// By the caller, or for want of memory and time.
    Stopped(ModelError),
    Refused(String),
}

/// The scene at finite strain, and its answer.
pub(super) fn solved(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<(Scene, Answer), NoAnswer> {
    // What is expected to take some steps is not to take hundreds: whoever wants that asks for the method by its name.
    let method = Method::FemNonlinear;
    let settings = Settings { method, advance: Advance::AtOnce, ..settings.clone() };
    let scene = Scene::unless_stopped(case, plan, &settings, &StopQuery::of(progress));
    let scene = scene.map_err(|none| match none {
        NoScene::Refused(errors) => NoAnswer::Refused(errors.to_string()),
        NoScene::Stopped => NoAnswer::Stopped(ModelError::Solver(SolverError::Stopped)),
    })?;
    if scene.warnings.iter().any(|warning| warning.code == FIBRES_IGNORED) {
        let why = "at finite strain fibres only pull, and those of this tissue also push";
        return Err(NoAnswer::Refused(why.to_owned()));
    }
    match answer::solve_without_doubt(&scene, progress) {
        Ok(answer) => Ok((scene, answer)),
        Err(error @ ModelError::Solver(SolverError::Stopped)) => Err(NoAnswer::Stopped(error)),
        Err(error) => Err(NoAnswer::Refused(error.to_string())),
    }
}
