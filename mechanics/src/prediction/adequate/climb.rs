//! Search for the cheapest adequate model: models in the order of their cost, until one is accurate enough.

use super::accepted::{Accepted, MeanErrors};
use super::crossing::overlap;
use super::duration::{SECOND_ORDER_TAKES, newton_relative_time};
use super::rung::{Considered, Errors, Rung};
use crate::mesh::{Vector, Warning};
use crate::model::fem::finite_strain::Advance;
use crate::model::fem::strain::deformations;
use crate::model::problem::ModelError;
use crate::prediction::answer::{self, Answer, Linear};
use crate::prediction::case::{Case, Plan, Settings};
use crate::prediction::fibres::FIBRES_IGNORED;
use crate::prediction::method::Method;
use crate::prediction::scene::Scene;
use crate::prediction::{Prediction, described};
use crate::progress::Progress;
use crate::solver::SolverError;

/// A rung that is not adequate is tried if it is expected to leave at most this share of the error so far, and one is as good as
/// the best if its error is at most so many times as large.
const WORTHWHILE: f64 = 0.8;

/// The third order of a plan is about this much times the square of the second over the first.
const THIRD: f64 = 1.5;

/// A third order above this share of the second is that of a series that does not end soon.
const TRUSTED: f64 = 0.5;

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

/// Progress, and the time in s since some moment.
#[derive(Clone, Copy)]
pub struct TimedProgress<'a> {
    pub stopwatch: &'a dyn Fn() -> f64,
    pub progress: &'a dyn Progress,
}

/// Predicts a case under a plan by the cheapest rung whose estimated error is accepted; `linear` is its scene with linear finite
/// elements, `stopwatch` tells seconds.
pub fn predict_adequately(
    case: &Case,
    plan: &Plan,
    linear: &Scene,
    accepted: &Accepted,
    watched: TimedProgress,
) -> Result<Adequate, ModelError> {
    let mut climb = Climb {
        scene: linear,
        accepted,
        watched,
        begun: (watched.stopwatch)(),
        linear_s: 0.0,
        newton_relative_time: newton_relative_time(1.0),
        in_contact: false,
        moving: linear.skin.points(),
        errors: Errors::default(),
        considered: Vec::new(),
    };
    climb.run(case, plan)
}

/// Answers of the rungs that were tried.
struct Answers {
    linear: Answer,
    second_order: Option<Answer>,
    finite_strain: Option<(Scene, Answer)>,
}

struct Climb<'a> {
    scene: &'a Scene,
    accepted: &'a Accepted,
    watched: TimedProgress<'a>,
    begun: f64,
    /// Time of the linear solution with its estimates.
    linear_s: f64,
    /// Newton's method as a multiple of that.
    newton_relative_time: f64,
    /// Whether tissue presses on something in the linear answer: what linearity leaves out is not estimated then.
    in_contact: bool,
    /// Points of the skin that the linear answer moves.
    moving: Vec<u32>,
    errors: Errors,
    considered: Vec<Considered>,
}

enum Failure {
    /// By the caller, or for want of memory and time.
    Stopped(ModelError),
    Refused(String),
}

impl Climb<'_> {
    fn run(&mut self, case: &Case, plan: &Plan) -> Result<Adequate, ModelError> {
        // 1. The linear answer, and what it tells of itself.
        let TimedProgress { progress, .. } = self.watched;
        let solved = answer::linear(self.scene, progress)?;
        let known = match &solved {
            Linear::Solved(known) => Some(&**known),
            Linear::Other(_) => None,
        };
        self.read_linear_answer(&solved);
        self.linear_s = self.elapsed();
        self.note(Rung::Linear, Some(self.linear_s), self.linear_s);

        // 2. To second order, by the same matrix.
        let mut second_order = None;
        if let Some(known) = known
            && self
                .is_affordable(Rung::SecondOrder, self.second_order_expected(known.displacement()))
        {
            let begun = self.elapsed();
            let found = known.to_second_order(self.scene, progress)?;
            let third = found.nonlinearity.as_ref().ok();
            self.errors.third_order = third.map(|left| self.means(&left.left_out));
            if self.is_a_series() {
                second_order = Some(found);
                self.note(
                    Rung::SecondOrder,
                    Some(self.elapsed() - begun),
                    self.time_of(Rung::SecondOrder),
                );
            } else {
                self.errors.third_order = None;
                let why = "its series is not to be trusted for this plan";
                self.pass_over(Rung::SecondOrder, why.to_owned());
            }
        }

        // 3. At finite strain.
        let mut finite_strain = None;
        if self.is_affordable(Rung::FiniteStrain, self.errors.on(Rung::FiniteStrainCorrected)) {
            let begun = self.elapsed();
            match at_finite_strain(case, plan, &self.scene.settings, progress) {
                Ok((scene, found)) => {
                    let mesh = found.numerical_error.as_ref().ok();
                    let mesh = mesh.map(|error| self.means(&error.missing));
                    self.errors.mesh_at_rest = mesh;
                    let spent = self.elapsed() - begun;
                    self.note(Rung::FiniteStrain, Some(spent), self.time_of(Rung::FiniteStrain));
                    self.refuse_correction(&scene, &found);
                    finite_strain = Some((scene, found));
                }
                Err(Failure::Stopped(error)) => return Err(error),
                Err(Failure::Refused(why)) => self.pass_over(Rung::FiniteStrain, why),
            }
        }

        // 4. The one that does.
        let linear = match solved {
            Linear::Solved(known) => known.into_answer(self.scene)?,
            Linear::Other(answer) => *answer,
        };
        Ok(self.taken(Answers { linear, second_order, finite_strain }))
    }

    /// Reads the estimates of the linear solution.
    fn read_linear_answer(&mut self, solved: &Linear) {
        let (displacement, mesh, linearity) = match solved {
            Linear::Solved(own) => (own.displacement(), &own.numerical_error, &own.nonlinearity),
            Linear::Other(own) => {
                self.in_contact = own.contact.is_some();
                (&*own.equilibrium.displacement, &own.numerical_error, &own.nonlinearity)
            }
        };
        self.moving = self.scene.skin.moving_points(displacement);
        self.newton_relative_time = newton_relative_time(least_det_f(self.scene, displacement));
        self.errors.mesh = mesh.as_ref().ok().map(|error| self.means(&error.missing));
        self.errors.linearity = linearity.as_ref().ok().map(|left| self.means(&left.left_out));
    }

    fn taken(&mut self, answers: Answers) -> Adequate {
        let rung = self.chosen();
        let error = self.errors.on(rung);
        let is_met = self.accepted.share(error.as_ref()) <= 1.0;
        let is_corrected = rung.is_corrected();
        let Answers { linear, second_order, finite_strain } = answers;
        let progress = self.watched.progress;
        let as_linear = |answer: Answer| {
            (None, described(self.scene, answer.corrected(is_corrected), progress))
        };
        let (scene, mut prediction) = match (rung.solution(), second_order, finite_strain) {
            (Rung::SecondOrder, Some(answer), _) => as_linear(answer),
            (Rung::FiniteStrain, _, Some((scene, answer))) => {
                let prediction = described(&scene, answer.corrected(is_corrected), progress);
                (Some(scene), prediction)
            }
            (_, _, _) => as_linear(linear),
        };
        prediction.warnings.extend((!is_met).then(|| not_met(error.as_ref(), self.accepted)));
        let overlap = overlap(&self.scene.skin, &prediction, self.accepted);
        let is_met = is_met && overlap.is_none();
        prediction.warnings.extend(overlap);
        let considered = std::mem::take(&mut self.considered);
        Adequate { prediction, scene, rung, errors: self.errors.clone(), considered, is_met }
    }

    fn means(&self, values: &[Vector]) -> MeanErrors {
        MeanErrors::of(&self.scene.skin, &self.moving, self.accepted, values)
    }

    fn elapsed(&self) -> f64 {
        (self.watched.stopwatch)() - self.begun
    }

    /// How long a rung is expected to take, in s.
    fn time_of(&self, rung: Rung) -> f64 {
        match rung.solution() {
            Rung::SecondOrder | Rung::SecondOrderCorrected => SECOND_ORDER_TAKES * self.linear_s,
            Rung::FiniteStrain | Rung::FiniteStrainCorrected => {
                self.newton_relative_time * self.linear_s
            }
            Rung::Linear | Rung::Corrected => self.linear_s,
        }
    }

    /// Mean errors that the second order is expected to leave, before its third order is known.
    fn second_order_expected(&self, first_order: &[Vector]) -> Option<MeanErrors> {
        let first = self.means(first_order).skin_mm;
        let second = self.errors.linearity.as_ref()?;
        let share = (THIRD * second.skin_mm / first).min(1.0);
        let third_order = Some(second.map(|error| error * share));
        Errors { third_order, ..self.errors.clone() }.on(Rung::SecondOrderCorrected)
    }

    /// Whether the third order is small beside the second.
    fn is_a_series(&self) -> bool {
        match (&self.errors.third_order, &self.errors.linearity) {
            (Some(third), Some(second)) => third.skin_mm <= TRUSTED * second.skin_mm,
            (_, _) => false,
        }
    }

    /// Whether a model fits the budget and may be accurate enough; `expected` is its least error. Otherwise notes the
    /// reason.
    fn is_affordable(&mut self, rung: Rung, expected: Option<MeanErrors>) -> bool {
        let share = self.accepted.share(expected.as_ref());
        let so_far = self.least_share();
        let left = self.accepted.time_s - self.elapsed();
        let why = if so_far <= 1.0 {
            "the expected error of a cheaper model is accepted".to_owned()
        } else if expected.is_none() && !self.in_contact {
            "its error is not known".to_owned()
        } else if share > 1.0 && share > WORTHWHILE * so_far {
            "it is not expected to be clearly better".to_owned()
        } else if let (Some(why), Rung::FiniteStrain) = (&self.accepted.no_finite_strain, rung) {
            why.clone()
        } else if self.time_of(rung) > left {
            let takes = self.time_of(rung);
            format!("it is expected to take {takes:.1} s, and {left:.1} s are left")
        } else {
            return true;
        };
        self.pass_over(rung, why);
        false
    }

    /// Notes a solution and its correction.
    fn note(&mut self, solution: Rung, spent_s: Option<f64>, expected_s: f64) {
        for rung in Rung::ALL.into_iter().filter(|rung| rung.solution() == solution) {
            let error = self.errors.on(rung);
            let unknown = rung.is_corrected() && error.is_none();
            let passed_over = unknown.then(|| "its error is not known".to_owned());
            self.considered.push(Considered { rung, error, spent_s, expected_s, passed_over });
        }
    }

    fn pass_over(&mut self, solution: Rung, why: String) {
        let expected_s = self.time_of(solution);
        for rung in Rung::ALL.into_iter().filter(|rung| rung.solution() == solution) {
            let (error, passed_over) = (self.errors.on(rung), Some(why.clone()));
            self.considered.push(Considered {
                rung,
                error,
                spent_s: None,
                expected_s,
                passed_over,
            });
        }
    }

    /// Passes over the corrected answer where something presses, and where what is added turns cells inside out that the answer
    /// itself does not.
    fn refuse_correction(&mut self, scene: &Scene, found: &Answer) {
        let Ok(error) = &found.numerical_error else { return };
        let pairs = found.equilibrium.displacement.iter().zip(&error.missing);
        let corrected: Vec<Vector> = pairs.map(|(u, missing)| u + missing).collect();
        let why = if found.contact.is_some() {
            "what the mesh leaves out is not added where tissue presses on what it touches"
        } else if least_det_f(scene, &corrected) <= 0.0 {
            "what the mesh is estimated to leave out would turn cells inside out"
        } else {
            return;
        };
        let of_it = |considered: &&mut Considered| considered.rung == Rung::FiniteStrainCorrected;
        for considered in self.considered.iter_mut().filter(of_it) {
            considered.passed_over = Some(why.to_owned());
        }
    }

    /// The rungs that were tried, with their errors as shares of what is accepted.
    fn shares(&self) -> impl Iterator<Item = (Rung, f64)> {
        let tried = self.considered.iter().filter(|rung| rung.passed_over.is_none());
        tried.map(|considered| (considered.rung, self.accepted.share(considered.error.as_ref())))
    }

    fn least_share(&self) -> f64 {
        self.shares().map(|(_, share)| share).fold(f64::INFINITY, f64::min)
    }

    /// The first rung that is adequate, or else the first that is nearly as good as the best. In contact, where no error is known,
    /// finite strain where it was tried: linear elements hold nodes against faces that small strain makes too large.
    fn chosen(&self) -> Rung {
        let least = self.least_share();
        if self.in_contact && least.is_infinite() {
            let solved = self.shares().filter(|(rung, _)| !rung.is_corrected());
            return solved.last().map_or(Rung::Linear, |(rung, _)| rung);
        }
        let enough = if least <= 1.0 { 1.0 } else { least / WORTHWHILE };
        let found = self.shares().find(|(_, share)| *share <= enough);
        found.map_or(Rung::Linear, |(rung, _)| rung)
    }
}

/// Of the cell that a displacement presses most, or turns inside out.
fn least_det_f(scene: &Scene, displacement: &[Vector]) -> f64 {
    let cells = deformations(&scene.mesh, displacement);
    cells.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min)
}

fn at_finite_strain(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<(Scene, Answer), Failure> {
    // What is expected to take some steps is not to take hundreds: whoever wants that asks for the method by its name.
    let method = Method::FemNonlinear;
    let settings = Settings { method, advance: Advance::AtOnce, ..settings.clone() };
    let scene =
        Scene::new(case, plan, &settings).map_err(|errors| Failure::Refused(errors.to_string()))?;
    if scene.warnings.iter().any(|warning| warning.code == FIBRES_IGNORED) {
        let why = "at finite strain fibres only pull, and those of this tissue also push";
        return Err(Failure::Refused(why.to_owned()));
    }
    match answer::solve(&scene, progress) {
        Ok(answer) => Ok((scene, answer)),
        Err(error @ ModelError::Solver(SolverError::Stopped)) => Err(Failure::Stopped(error)),
        Err(error) => Err(Failure::Refused(error.to_string())),
    }
}

fn not_met(error: Option<&MeanErrors>, accepted: &Accepted) -> Warning {
    let wanted = accepted.skin_mm;
    let Some(error) = error else {
        let detail = "how far the skin is off is not known".to_owned();
        return Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    };
    let skin = error.skin_mm;
    let detail = match accepted
        .regions_mm
        .iter()
        .find(|(name, accepted)| error.regions_mm.get(*name).is_none_or(|error| error > *accepted))
    {
        Some((name, wanted)) if skin <= accepted.skin_mm => {
            let own = error.regions_mm.get(name).copied().unwrap_or(f64::NAN);
            format!(
                "{name:?} is expected to be off by {own:.3} mm in the mean, and {wanted:.3} mm were to be met"
            )
        }
        Some(_) | None => format!(
            "the skin that moves is expected to be off by {skin:.3} mm in the mean, and {wanted:.3} mm were to be met: no adequate \
             model fits the mesh, the time and the case"
        ),
    };
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    warning.with("expected_mm", skin)
}
