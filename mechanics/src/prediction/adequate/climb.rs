//! Search for the cheapest adequate model: models in the order of their cost, until one is accurate enough.

use std::collections::BTreeMap;

use super::accepted::{Accepted, MeanErrors, TimedProgress, not_met};
use super::duration::{ROUNDS_TAKE, SECOND_ORDER_TAKES, least_det_f, newton_relative_time};
use super::finite_strain::{self, NoAnswer};
use super::objection::{CandidateAnswer, Objection, why_dearer};
use super::rung::{
    Considered, Errors, Rung, WORTHWHILE, cheapest, collapses, error_over_estimate,
    error_over_estimate_at_rest,
};
use crate::mesh::Vector;
use crate::model::problem::ModelError;
use crate::prediction::answer::{self, Answer, Linear};
use crate::prediction::case::{Case, Plan};
use crate::prediction::following_pressure::has_pressure;
use crate::prediction::scene::Scene;
use crate::prediction::{Prediction, described};

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
    /// What speaks against the answer whatever its error is expected to be.
    pub objections: Vec<Objection>,
    /// Whether its expected error is accepted, and nothing speaks against it.
    pub is_met: bool,
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
        gains_little: linear.correction_gains_little(),
        moving: linear.skin.points(),
        errors: Errors::default(),
        considered: Vec::new(),
        objections: BTreeMap::new(),
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
    /// Whether a correction is expected to leave too much.
    gains_little: bool,
    /// Points of the skin that the linear answer moves.
    moving: Vec<u32>,
    errors: Errors,
    considered: Vec<Considered>,
    /// Of each answer that is there.
    objections: BTreeMap<Rung, Vec<Objection>>,
}

impl Climb<'_> {
    fn run(&mut self, case: &Case, plan: &Plan) -> Result<Adequate, ModelError> {
        // 1. The linear answer, and what it tells of itself.
        let TimedProgress { progress, .. } = self.watched;
        let solved = match answer::linear(self.scene, progress) {
            Err(error @ ModelError::ContactUnsettled { .. }) => {
                return self.beyond_linear_contact(error, case, plan);
            }
            ended => ended?,
        };
        let known = match &solved {
            Linear::Solved(known) => Some(&**known),
            Linear::Other(_) => None,
        };
        let first = CandidateAnswer::of_linear(self.scene, &solved);
        self.read_linear_answer(&solved, &first);
        self.linear_s = self.elapsed();
        self.note(Rung::Linear, self.linear_s, &first);

        // 2. To second order, by the same matrix.
        let mut second_order = None;
        let expected = self.second_order_expected(&first.equilibrium.displacement);
        if let Some(known) = known
            && self.is_affordable(Rung::SecondOrder, expected)
        {
            let begun = self.elapsed();
            let found = known.to_second_order(self.scene, progress)?;
            let third = found.nonlinearity.as_ref().ok();
            self.errors.third_order = third.map(|left| self.means(&left.left_out));
            if self.is_a_series() {
                let spent = self.elapsed() - begun;
                self.note(Rung::SecondOrder, spent, &CandidateAnswer::of(self.scene, &found));
                second_order = Some(found);
            } else {
                self.errors.third_order = None;
                let why = "its series is not to be trusted for this plan";
                self.pass_over(Rung::SecondOrder, why.to_owned());
            }
        }

        // 3. At finite strain.
        let finite_strain = self.at_finite_strain(case, plan)?;
        if let (Some(known), Some((_, found))) = (known, &finite_strain) {
            let mean = |values: &[Vector]| self.means(values).skin_mm;
            let objection = finite_strain::another_branch(known, found, self.accepted, mean);
            for rung in [Rung::FiniteStrain, Rung::FiniteStrainCorrected] {
                self.objections.entry(rung).or_default().extend(objection.clone());
            }
        }

        // 4. The one that does.
        let linear = match solved {
            Linear::Solved(known) => known.into_answer(self.scene)?,
            Linear::Other(answer) => *answer,
        };
        Ok(self.taken(Answers { linear, second_order, finite_strain }))
    }

    /// The answer at finite strain, if it may be accurate enough and there is one.
    fn at_finite_strain(
        &mut self,
        case: &Case,
        plan: &Plan,
    ) -> Result<Option<(Scene, Answer)>, ModelError> {
        let expected = self.errors.expected(self.best_of(Rung::FiniteStrain));
        if !self.is_affordable(Rung::FiniteStrain, expected) {
            return Ok(None);
        }
        let begun = self.elapsed();
        match finite_strain::solved(case, plan, &self.scene.settings, self.watched.progress) {
            Ok((scene, found)) => {
                let own = CandidateAnswer::of(&scene, &found);
                if self.moving.is_empty() {
                    self.moving = scene.skin.moving_points(&own.equilibrium.displacement);
                }
                let times = error_over_estimate_at_rest(&scene, own.equilibrium);
                self.errors.mesh_at_rest =
                    own.missing.map(|missing| self.means(missing).map(|error| times * error));
                self.note(Rung::FiniteStrain, self.elapsed() - begun, &own);
                Ok(Some((scene, found)))
            }
            Err(NoAnswer::Stopped(error)) => Err(error),
            Err(NoAnswer::Refused(why)) => {
                self.pass_over(Rung::FiniteStrain, why);
                Ok(None)
            }
        }
    }

    /// The answer at finite strain where contact in linear elasticity does not settle; without one that is the error.
    fn beyond_linear_contact(
        &mut self,
        error: ModelError,
        case: &Case,
        plan: &Plan,
    ) -> Result<Adequate, ModelError> {
        self.in_contact = true;
        self.linear_s = self.elapsed();
        self.moving.clear();
        for rung in [Rung::Linear, Rung::SecondOrder] {
            self.pass_over(rung, error.to_string());
        }
        let (scene, answer) = self.at_finite_strain(case, plan)?.ok_or(error)?;
        let rung = self.chosen();
        Ok(self.adequate(rung, Some(scene), answer))
    }

    /// Reads the estimates of the linear solution.
    fn read_linear_answer(&mut self, solved: &Linear, first: &CandidateAnswer) {
        let linearity = match solved {
            Linear::Solved(own) => &own.nonlinearity,
            Linear::Other(own) => {
                self.in_contact = own.contact.is_some();
                &own.nonlinearity
            }
        };
        let displacement = &first.equilibrium.displacement;
        self.moving = self.scene.skin.moving_points(displacement);
        let rounds = if has_pressure(self.scene) { ROUNDS_TAKE } else { 1.0 };
        self.newton_relative_time =
            rounds * newton_relative_time(least_det_f(&self.scene.mesh, displacement));
        self.errors.mesh = first.missing.map(|missing| self.mesh_means(missing));
        self.errors.linearity = linearity.as_ref().ok().map(|left| self.means(&left.left_out));
    }

    fn taken(&mut self, answers: Answers) -> Adequate {
        let rung = self.chosen();
        let Answers { linear, second_order, finite_strain } = answers;
        let (scene, answer) = match (rung.solution(), second_order, finite_strain) {
            (Rung::SecondOrder, Some(answer), _) => (None, answer),
            (Rung::FiniteStrain, _, Some((scene, answer))) => (Some(scene), answer),
            (_, _, _) => (None, linear),
        };
        self.adequate(rung, scene, answer)
    }

    /// The prediction of a rung, with the scene of its answer where that is not the linear one.
    fn adequate(&mut self, rung: Rung, scene: Option<Scene>, answer: Answer) -> Adequate {
        let error = self.errors.on(rung);
        let is_accepted = self.accepted.share(error.as_ref()) <= 1.0;
        let objections = self.objections.remove(&rung).unwrap_or_default();
        let own = scene.as_ref().unwrap_or(self.scene);
        let answer = answer.corrected(rung.is_corrected());
        let mut prediction = described(own, answer, self.watched.progress);
        let warnings = &mut prediction.warnings;
        warnings.extend((!is_accepted).then(|| not_met(error.as_ref(), self.accepted)));
        warnings.extend(objections.iter().map(|own| own.not_met(self.accepted)));
        let is_met = is_accepted && objections.is_empty();
        let (errors, considered) = (self.errors.clone(), std::mem::take(&mut self.considered));
        Adequate { prediction, scene, rung, errors, considered, objections, is_met }
    }

    fn means(&self, values: &[Vector]) -> MeanErrors {
        MeanErrors::of(&self.scene.skin, &self.moving, self.accepted, values)
    }

    /// Of what a mesh leaves out.
    fn mesh_means(&self, missing: &[Vector]) -> MeanErrors {
        let times = error_over_estimate(self.scene);
        self.means(missing).map(|error| times * error)
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
        Errors { third_order, ..self.errors.clone() }.on(self.best_of(Rung::SecondOrder))
    }

    /// The better of a solution and its correction.
    fn best_of(&self, solution: Rung) -> Rung {
        let may_be_taken = |rung: &Rung| !(rung.is_corrected() && self.gains_little);
        let own = |rung: &Rung| rung.solution() == solution && may_be_taken(rung);
        Rung::ALL.into_iter().rfind(own).unwrap_or(solution)
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

    /// Notes a solution and its correction, with what speaks against them.
    fn note(&mut self, solution: Rung, spent_s: f64, found: &CandidateAnswer) {
        let expected_s = self.time_of(solution);
        for rung in Rung::ALL.into_iter().filter(|rung| rung.solution() == solution) {
            let error = self.errors.on(rung);
            let (spent_s, passed_over) = (Some(spent_s), self.why_not(rung, error.as_ref(), found));
            self.considered.push(Considered { rung, error, spent_s, expected_s, passed_over });
        }
    }

    /// Why an answer that is there is not taken where a dearer model may do.
    fn why_not(
        &mut self,
        rung: Rung,
        error: Option<&MeanErrors>,
        found: &CandidateAnswer,
    ) -> Option<String> {
        if self.least_share() <= 1.0 {
            // The answer itself is adequate: what is corrected is not looked at, which takes its time.
            return None;
        }
        if rung.is_corrected() && error.is_none() {
            return Some("its error is not known".to_owned());
        }
        if let Some(why) = self.why_not_corrected(found).filter(|_| rung.is_corrected()) {
            return Some(why.to_owned());
        }
        let objections = found.objections(rung.is_corrected(), self.accepted);
        let why = why_dearer(&objections, self.accepted.share(error) <= 1.0);
        self.objections.insert(rung, objections);
        why
    }

    /// Why the estimate is not added to an answer.
    fn why_not_corrected(&self, found: &CandidateAnswer) -> Option<&'static str> {
        if found.contact.is_some() {
            Some("an estimate is not added where tissue is in contact")
        } else if self.gains_little {
            Some("an estimate of wedges, or of nearly incompressible hexahedra, is not added")
        } else {
            let collapses = collapses(self.scene, found.equilibrium);
            collapses.then_some("an estimate is not added where cells collapse")
        }
    }

    fn pass_over(&mut self, solution: Rung, why: String) {
        let expected_s = self.time_of(solution);
        for rung in Rung::ALL.into_iter().filter(|rung| rung.solution() == solution) {
            let (error, passed_over) = (self.errors.expected(rung), Some(why.clone()));
            self.considered.push(Considered {
                rung,
                error,
                spent_s: None,
                expected_s,
                passed_over,
            });
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

    /// The first rung that is adequate, or else the first that is nearly as good as the best. Where no error is known or something
    /// speaks against every answer, the dearest that was found: linear elements turn cells inside out, and in contact hold nodes
    /// against faces that small strain makes too large.
    fn chosen(&self) -> Rung {
        if self.least_share().is_infinite() {
            let is_there = |one: &&Considered| one.spent_s.is_some() && !one.rung.is_corrected();
            let found = self.considered.iter().rfind(is_there);
            return found.map_or(Rung::Linear, |found| found.rung);
        }
        cheapest(&self.shares().collect::<Vec<_>>()).unwrap_or(Rung::Linear)
    }
}
