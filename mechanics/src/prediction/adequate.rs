//! The cheapest adequate model: from rung to rung of rising cost until the estimated error of the skin is accepted.
//!
//! The rungs are linear finite elements; the same with what their mesh leaves out added (`numerical_error`); and the same elements
//! at finite strain. Two estimates come with the linear answer: e_m of its mesh and e_l of what linearity leaves out, both as
//! means over the skin. Linear elements are off by e_m + e_l, corrected ones by .8 e_m + e_l (adding the estimate took 21 to
//! 58 % off the error of a mesh: NONLINEAR, section 3), finite strain by e_m. The cheapest rung within what is accepted is
//! taken, and where there is none the most accurate one that the time allows, which is then said not to be adequate.

use super::answer::{self, Answer};
use super::case::{Case, Plan, Settings};
use super::method::Method;
use super::scene::Scene;
use super::{Prediction, described};
use crate::mesh::{Vector, Warning};
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::solver::SolverError;

/// What is left of the error of a mesh where its estimate is added.
const LEFT_BY_CORRECTION: f64 = 0.8;

/// How many times the time of the linear answer Newton's method is expected to take.
const STEPS_OF_NEWTON: f64 = 15.0;

/// What the caller accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accepted {
    /// The mean error over the skin, in mm.
    pub skin_mm: f64,
    /// For all rungs together, in s.
    pub time_s: f64,
}

/// A way to predict, of rising cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rung {
    Linear,
    Corrected,
    FiniteStrain,
}

/// Mean errors over the skin, as far as they are known, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the mesh.
    pub mesh_mm: Option<f64>,
    /// What linearity leaves out.
    pub linearity_mm: Option<f64>,
}

/// A rung that was stood on or passed over.
#[derive(Clone, Debug, PartialEq)]
pub struct Considered {
    pub rung: Rung,
    /// The mean error over the skin that is expected of it, in mm; none where it is not known.
    pub error_mm: Option<f64>,
    /// Time spent on it in s, where it was tried.
    pub spent_s: Option<f64>,
    /// Time it was expected to take in s.
    pub expected_s: f64,
    /// Why it was not taken.
    pub passed_over: Option<String>,
}

/// A prediction with the way to it.
pub struct Adequate {
    pub prediction: Prediction,
    /// The scene of the prediction, where it is not that of the linear rung.
    pub scene: Option<Scene>,
    pub rung: Rung,
    pub errors: Errors,
    pub considered: Vec<Considered>,
    pub is_met: bool,
}

impl Rung {
    /// As documents call it.
    pub fn name(self) -> &'static str {
        match self {
            Rung::Linear => "linear",
            Rung::Corrected => "corrected",
            Rung::FiniteStrain => "finite_strain",
        }
    }
}

impl Errors {
    fn of(scene: &Scene, answer: &Answer) -> Errors {
        let mean = |values: &[Vector]| {
            let nodes = scene.skin.nodes();
            let sum: f64 = nodes.iter().map(|&node| values[node as usize].norm()).sum();
            sum / nodes.len().max(1) as f64
        };
        Errors {
            mesh_mm: answer.numerical_error.as_ref().ok().map(|error| mean(&error.missing)),
            linearity_mm: answer.nonlinearity.as_ref().ok().map(|left| mean(&left.second_order)),
        }
    }

    /// The mean error over the skin of an answer of a rung.
    fn on(&self, rung: Rung) -> Option<f64> {
        match rung {
            Rung::Linear => Some(self.mesh_mm? + self.linearity_mm?),
            Rung::Corrected => Some(LEFT_BY_CORRECTION * self.mesh_mm? + self.linearity_mm?),
            Rung::FiniteStrain => self.mesh_mm,
        }
    }
}

/// Predicts a case under a plan by the cheapest rung whose estimated error is accepted; `linear` is its scene with linear finite
/// elements, `stopwatch` tells seconds.
pub fn predict_adequately(
    case: &Case,
    plan: &Plan,
    linear: &Scene,
    accepted: Accepted,
    progress: Watched,
) -> Result<Adequate, ModelError> {
    let Watched { stopwatch, progress } = progress;
    let begun = stopwatch();
    let answer = answer::solve(linear, progress)?;
    let spent = stopwatch() - begun;
    let errors = Errors::of(linear, &answer);
    let expected = |rung: Rung| match rung {
        Rung::Linear | Rung::Corrected => spent,
        Rung::FiniteStrain => STEPS_OF_NEWTON * spent,
    };
    let mut considered: Vec<Considered> = [Rung::Linear, Rung::Corrected, Rung::FiniteStrain]
        .into_iter()
        .map(|rung| Considered {
            rung,
            error_mm: errors.on(rung),
            spent_s: (rung != Rung::FiniteStrain).then_some(spent),
            expected_s: expected(rung),
            passed_over: None,
        })
        .collect();
    pass_over(&mut considered, accepted, spent);
    let mut chosen = chosen(&considered, accepted);
    let mut finite = None;
    if chosen == Rung::FiniteStrain {
        let begun = stopwatch();
        match at_finite_strain(case, plan, &linear.settings, progress) {
            Ok(found) => finite = Some(found),
            Err(Failure::Stopped(error)) => return Err(error),
            Err(Failure::Refused(why)) => {
                considered[2].passed_over = Some(why);
                chosen = self::chosen(&considered, accepted);
            }
        }
        considered[2].spent_s = Some(stopwatch() - begun);
    }
    let is_met = errors.on(chosen).is_some_and(|error| error <= accepted.skin_mm);
    let (scene, mut prediction) = match finite {
        Some((scene, prediction)) => (Some(scene), prediction),
        None => (None, described(linear, answer.corrected(chosen == Rung::Corrected), progress)),
    };
    prediction.warnings.extend((!is_met).then(|| not_met(errors.on(chosen), accepted)));
    Ok(Adequate { prediction, scene, rung: chosen, errors, considered, is_met })
}

/// Progress, and the time in s since some moment.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    pub stopwatch: &'a dyn Fn() -> f64,
    pub progress: &'a dyn Progress,
}

/// Says of each rung why it is out of the question.
fn pass_over(considered: &mut [Considered], accepted: Accepted, spent: f64) {
    for rung in considered {
        if rung.error_mm.is_none() && rung.rung != Rung::Linear {
            rung.passed_over = Some("its error is not known".to_owned());
        } else if rung.spent_s.is_none() && spent + rung.expected_s > accepted.time_s {
            rung.passed_over = Some(format!(
                "it is expected to take {:.1} s, and {:.1} s are left",
                rung.expected_s,
                accepted.time_s - spent
            ));
        }
    }
}

/// The first rung that is adequate, or else the most accurate one.
fn chosen(considered: &[Considered], accepted: Accepted) -> Rung {
    let open = || considered.iter().filter(|rung| rung.passed_over.is_none());
    let error = |rung: &Considered| rung.error_mm.unwrap_or(f64::INFINITY);
    let adequate = open().find(|rung| error(rung) <= accepted.skin_mm);
    let nearest = || open().min_by(|a, b| error(a).total_cmp(&error(b)));
    adequate.or_else(nearest).map_or(Rung::Linear, |rung| rung.rung)
}

enum Failure {
    /// By the caller, or for want of memory and time.
    Stopped(ModelError),
    Refused(String),
}

fn at_finite_strain(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<(Scene, Prediction), Failure> {
    let settings = Settings { method: Method::FemNonlinear, ..settings.clone() };
    let scene =
        Scene::new(case, plan, &settings).map_err(|errors| Failure::Refused(errors.to_string()))?;
    match super::predict(&scene, progress) {
        Ok(prediction) => Ok((scene, prediction)),
        Err(error @ ModelError::Solver(SolverError::Stopped)) => Err(Failure::Stopped(error)),
        Err(error) => Err(Failure::Refused(error.to_string())),
    }
}

fn not_met(error: Option<f64>, accepted: Accepted) -> Warning {
    let wanted = accepted.skin_mm;
    let detail = match error {
        Some(error) => format!(
            "the skin is expected to be off by {error:.3} mm in the mean, and {wanted:.3} mm were to be met: no adequate \
             model fits the mesh, the time and the case"
        ),
        None => "how far the skin is off is not known".to_owned(),
    };
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    match error {
        Some(error) => warning.with("expected_mm", error),
        None => warning,
    }
}
