//! Reference solutions of a scene: one with contact for answers with contact, one without for the others.

use super::StudyError;
use super::answer::{Answer, Refusal};
use super::error::{DisplacedSkin, Measured};
use super::levels::Levels;
use super::report::Solved;
use super::scan::{ScannedSkin, is_partial};
use super::truth::{TruthRequest, Truths};
use super::variant::{Strain, StudyScene, Truth, Variant};
use crate::prediction::{ContactKind, Skin};

/// The code of answers of finite strain that are held against a linear truth: their error has in it what linearity leaves out of
/// the truth.
pub const LINEAR_TRUTH: &str = "linear-truth";
/// The code of answers with contact that are held against a formula without: their error has in it what contact changes.
pub const TRUTH_WITHOUT_CONTACT: &str = "truth-without-contact";
/// The code of answers that are nearer to the truth than that is known: how good they are is not.
pub const WITHIN_TRUTH_ERROR: &str = "within-truth-error";

/// The share by which two errors that are one and the same may differ.
const ROUNDING: f64 = 1e-6;

/// The code of rows whose skin moves where a scan has nothing opposite.
const PARTIAL: &str = "partial-coverage";

/// Reference solutions of a scene.
pub(super) struct SceneTruths {
    without: Truths,
    with: Option<Truths>,
    pub words: String,
    /// Mean and p95 in mm, of the one that is farther off.
    pub error_mm: Option<[f64; 2]>,
}

impl SceneTruths {
    /// As far as answers without contact, and answers with contact, are to be held against it.
    pub(super) fn find(
        asked: &TruthRequest,
        levels: &mut Levels,
        [is_without, is_with]: [bool; 2],
    ) -> Result<Self, StudyError> {
        let without = match is_without {
            true => asked.find(levels, ContactKind::Sliding)?,
            false => asked.nothing(),
        };
        let with = match is_with {
            true => Some(asked.find(levels, ContactKind::Unilateral)?),
            false => None,
        };
        let words = match &with {
            None => without.words.clone(),
            Some(with) if is_without => {
                format!("{}. Of rows with contact: {}", without.words, with.words)
            }
            Some(with) => with.words.clone(),
        };
        let errors = [Some(&without), with.as_ref()].into_iter().flatten();
        let errors = errors.filter_map(|truths| truths.errors.largest());
        let error_mm = errors.max_by(|one, other| one[0].total_cmp(&other[0]));
        Ok(SceneTruths { without, with, words, error_mm })
    }

    /// Of a plan with its skin and a set of materials, by their places.
    pub(super) fn of<'a>(
        &'a self,
        scene: &StudyScene,
        skin: &'a Result<Skin, Refusal>,
        (plan, materials): (usize, usize),
    ) -> TrueSkins<'a> {
        let held = |truths: &'a Truths| ReferenceSkin {
            skin: DisplacedSkin::of(skin, &truths.skins[plan][materials], scene.truth.strain()),
            own_error: truths.errors.get(plan, materials),
        };
        TrueSkins::Displaced {
            without: Box::new(held(&self.without)),
            with: self.with.as_ref().map(held).map(Box::new),
            is_formula: matches!(scene.truth, Truth::ClosedForm(_)),
        }
    }
}

/// A true skin, and how far it is off itself, mean and p95 in mm, as far as that is known.
pub(super) struct ReferenceSkin<'a> {
    skin: Result<DisplacedSkin<'a>, Refusal>,
    own_error: Option<[f64; 2]>,
}

/// Reference solutions of one plan with one set of materials.
pub(super) enum TrueSkins<'a> {
    Displaced {
        without: Box<ReferenceSkin<'a>>,
        with: Option<Box<ReferenceSkin<'a>>>,
        is_formula: bool,
    },
    Scanned(&'a Result<ScannedSkin<'a>, Refusal>),
}

impl TrueSkins<'_> {
    /// Error of an answer of a variant.
    pub(super) fn judge(&self, variant: &Variant, answer: Answer) -> Result<Solved, Refusal> {
        let is_touching = variant.settings.contact.is_unilateral();
        match self {
            TrueSkins::Scanned(skin) => {
                let skin = skin.as_ref().map_err(Refusal::clone)?;
                let measured = skin.measure(&answer.displacement)?;
                Ok(solved(answer, measured, &[], (None, false)))
            }
            TrueSkins::Displaced { without, with, is_formula } => {
                let (held, truth_contact) = match with {
                    Some(with) if is_touching => (&**with, true),
                    Some(_) | None => (&**without, false),
                };
                let ReferenceSkin { skin, own_error } = held;
                let skin = skin.as_ref().map_err(Refusal::clone)?;
                let measured = skin.measure(&answer);
                let measured =
                    measured.map_err(|error| Refusal::new("not-measured", error.to_string()))?;
                let is_linear = skin.strain == Some(Strain::Small);
                // One mesh before the truth an error may be that of the truth, to the last digits.
                let is_within = |[own, _]: [f64; 2]| measured.error.mean <= own * (1.0 + ROUNDING);
                let within = own_error.is_some_and(is_within);
                let codes = [
                    (LINEAR_TRUTH, is_linear && answer.strain == Strain::Finite),
                    (TRUTH_WITHOUT_CONTACT, *is_formula && is_touching),
                    (WITHIN_TRUTH_ERROR, within),
                ];
                Ok(solved(answer, measured, &codes, (*own_error, truth_contact)))
            }
        }
    }
}

fn solved(
    mut answer: Answer,
    measured: Measured,
    codes: &[(&str, bool)],
    (truth_error, truth_contact): (Option<[f64; 2]>, bool),
) -> Solved {
    let partial = (PARTIAL, is_partial(measured.covered_share));
    let codes = codes.iter().chain([&partial]).filter(|(_, constraints)| *constraints);
    answer.warnings.extend(codes.map(|(code, _)| (*code).to_owned()));
    Solved {
        unknowns: answer.unknowns,
        iterations: answer.iterations,
        wall_s: answer.time.wall_s,
        repeats: answer.time.repeats,
        peak_mb: answer.time.peak_mb,
        skin_mean_mm: measured.skin_mean_mm,
        error: measured.error,
        closest_point: measured.closest_point,
        regions: measured.regions,
        numerical_error: measured.estimated.numerical_error,
        linearity_error: measured.estimated.linearity_error,
        effectivity: measured.estimated.effectivity,
        chosen: answer.chosen,
        smallest_det_f: answer.smallest_det_f,
        truth_error,
        truth_contact,
        warnings: answer.warnings,
        covered_share: measured.covered_share,
    }
}
