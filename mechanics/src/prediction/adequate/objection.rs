//! What speaks against an answer whatever its error is expected to be: warnings of things that no estimate of an error contains.
//!
//! | warning | speaks against an answer | a dearer model may be without it |
//! | --- | --- | --- |
//! | `cells-inverted` | always: estimates hold near states that tissue can have | yes, finite strain keeps every cell as it is turned |
//! | `skin-outruns-plan` | of small strain | yes, finite strain confirms it or not |
//! | `pressure-turned` | of small strain | yes, at finite strain pressure follows its faces |
//! | `tissue-may-buckle` | of small strain | yes, finite strain knows whether it is stable |
//! | `another-equilibrium` | where the state that was found is not stable, or lies farther from the second order than that from the linear answer | no |
//! | `skin-overlaps` | without contact, where it is deeper than at rest by more than is accepted, or nobody knows how deep | no |
//! | `contact-overlap`, `contact-points-move` | by more than is accepted | no |
//! | `contact-chatter` | always: there contact may pull | no |
//! | `membrane-wrinkles` | always: no mesh is fine enough | no |
//! | `thin-stiff-layer` | of a hundredth of the cells or more: the error of the mesh is estimated several times too small | no |
//! | `pressure-unsettled` | always: the forces are not those of the pressure stated | no |
//! | `solved-loosely` | always: estimates are of exact solutions | no |
//!
//! Others are contained in the estimates (`numerical-error-large`, `large-strain`, `locking`), say that an estimate is not known,
//! or are of the plan or the case, which no model mends (`tearing`, `bones-overlap`, `bone-in-tissue`, `bone-through-skin`).

use super::accepted::Accepted;
use crate::mesh::{Vector, Warning};
use crate::model::fem::finite_strain::ANOTHER_EQUILIBRIUM;
use crate::model::fem::strain::{determinants, inverted_cells};
use crate::model::problem::Equilibrium;
use crate::prediction::answer::{Answer, Linear};
use crate::prediction::contact::Touch;
use crate::prediction::far_skin;
use crate::prediction::following_pressure::{PRESSURE_UNSETTLED, pressure_turned};
use crate::prediction::loosely;
use crate::prediction::pressed_tissue::MAY_BUCKLE;
use crate::prediction::scene::Scene;
use crate::prediction::skin_overlap::{Deepest, SKIN_OVERLAPS, added_overlap, skin_overlap};
use crate::prediction::stiff_layer::{THIN_STIFF_LAYER, has_stiff_layers};
use crate::prediction::wrinkles::wrinkles;

/// An answer that may be adequate.
#[derive(Clone, Copy)]
pub(in crate::prediction) struct CandidateAnswer<'a> {
    pub scene: &'a Scene,
    pub equilibrium: &'a Equilibrium,
    /// What its mesh leaves out, where that is known.
    pub missing: Option<&'a [Vector]>,
    pub contact: Option<&'a Touch>,
}

/// A warning that no estimate of an error contains.
#[derive(Clone, Debug, PartialEq)]
pub struct Objection {
    pub warning: Warning,
    /// Whether a dearer model may be without it.
    pub is_of_model: bool,
}

impl<'a> CandidateAnswer<'a> {
    pub fn of_linear(scene: &'a Scene, answer: &'a Linear) -> Self {
        match answer {
            Linear::Solved(own) => {
                let missing = own.numerical_error.as_ref().ok();
                let missing = missing.map(|error| error.missing.as_slice());
                CandidateAnswer { scene, equilibrium: own.equilibrium(), missing, contact: None }
            }
            Linear::Other(own) => CandidateAnswer::of(scene, own),
        }
    }

    pub fn of(scene: &'a Scene, answer: &'a Answer) -> Self {
        let missing = answer.numerical_error.as_ref().ok();
        CandidateAnswer {
            scene,
            equilibrium: &answer.equilibrium,
            missing: missing.map(|error| error.missing.as_slice()),
            contact: answer.contact.as_ref(),
        }
    }

    /// What speaks against it, or against it with what its mesh leaves out added, where so many mm are accepted.
    pub fn objections(&self, is_corrected: bool, accepted: &Accepted) -> Vec<Objection> {
        let CandidateAnswer { scene, equilibrium, missing, contact } = *self;
        let mut displacement = equilibrium.displacement.clone();
        for (u, missing) in
            displacement.iter_mut().zip(missing.filter(|_| is_corrected).into_iter().flatten())
        {
            *u += missing;
        }
        let is_small_strain = scene.settings.method.properties().is_small_strain;
        let outruns = far_skin::outrun(scene, &displacement).filter(|_| is_small_strain);
        let inverted = inverted_cells(&determinants(&scene.mesh, &displacement));
        let turned = pressure_turned(scene, &displacement);
        let pressed = equilibrium.warnings.iter().filter(|own| own.code == MAY_BUCKLE).cloned();
        let of_model = inverted.into_iter().chain(outruns).chain(turned).chain(pressed);
        let newton = equilibrium.solver.newton.as_ref();
        let is_unstable = newton.is_some_and(|newton| newton.is_stable == Some(false));
        let speaks = |own: &&Warning| match own.code {
            ANOTHER_EQUILIBRIUM => is_unstable,
            code => code == PRESSURE_UNSETTLED,
        };
        let of_solution = equilibrium.warnings.iter().filter(speaks);
        let mut of_scene = scene.warnings.iter();
        let of_scene = of_scene.find(|own| own.code == THIN_STIFF_LAYER && has_stiff_layers(scene));
        // In contact edges may cross by less than is measured; what is measured is `contact-overlap`.
        let without_contact = contact.is_none();
        let touches = contact.into_iter().flat_map(|touch| touch.warnings(scene));
        let of_all = of_solution
            .chain(of_scene)
            .cloned()
            .chain(loosely(scene, &equilibrium.solver))
            .chain(wrinkles(scene, &displacement))
            .chain(touches.filter(|own| speaks_against_contact(own, accepted)))
            .chain(without_contact.then(|| overlap(scene, &displacement, accepted)).flatten());
        let of_model = of_model.map(|warning| Objection { warning, is_of_model: true });
        of_model.chain(of_all.map(|warning| Objection { warning, is_of_model: false })).collect()
    }
}

impl Objection {
    /// As the answer says that what was asked is not met.
    pub fn not_met(&self, accepted: &Accepted) -> Warning {
        let detail = format!("{}: no error estimate includes that", self.warning.detail);
        let warning =
            Warning::new("tolerance-not-met", detail).with("accepted_mm", accepted.skin_mm);
        let numbers = self.warning.numbers.iter();
        numbers.fold(warning, |warning, (name, value)| warning.with(name, *value))
    }
}

/// Why a dearer model is tried: what it may be without. An accurate answer with something that no model is without is the best there
/// is.
pub(super) fn why_dearer(objections: &[Objection], is_accurate: bool) -> Option<String> {
    let (of_model, others): (Vec<&Objection>, Vec<_>) =
        objections.iter().partition(|own| own.is_of_model);
    let told: Vec<&str> = of_model.iter().map(|own| own.warning.detail.as_str()).collect();
    let is_best = is_accurate && !others.is_empty();
    (!told.is_empty() && !is_best).then(|| told.join("; "))
}

fn speaks_against_contact(warning: &Warning, accepted: &Accepted) -> bool {
    let is_above = |name: &str| {
        let mut numbers = warning.numbers.iter();
        numbers.any(|(own, value)| *own == name && *value > accepted.skin_mm)
    };
    match warning.code {
        "contact-chatter" => true,
        "contact-overlap" => is_above("depth_mm"),
        "contact-points-move" => is_above("moved_mm"),
        _ => false,
    }
}

/// Where the skin newly passes through itself, deeper than the error that is accepted or nobody knows how deep.
fn overlap(scene: &Scene, displacement: &[Vector], accepted: &Accepted) -> Option<Warning> {
    let moved = scene.skin.moved(displacement);
    let told = skin_overlap(&scene.skin, &moved)?;
    let Some(Deepest { depth, at, .. }) = added_overlap(&scene.skin, &moved) else {
        let detail = format!("{}, at an unknown depth", told.detail);
        return Some(Warning { detail, ..told });
    };
    if depth <= accepted.skin_mm {
        return None;
    }
    let detail = format!(
        "the skin passes through itself {depth:.2} mm deeper than before the movement, more than the accepted {:.3} mm; request `contact` to \
         prevent it",
        accepted.skin_mm
    );
    let warning = Warning::new(SKIN_OVERLAPS, detail).with("depth_mm", depth);
    Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
}
