//! Run of a study: rows first, each alone in memory, then the reference solution they are compared with.

use super::Stopwatch;
use super::answer::{Answer, Bench, NoAnswer, Refusal};
use super::cell_sizes::cell_size;
use super::failure::StudyError;
use super::held_against::{SceneTruths, TrueSkins};
use super::levels::Levels;
use super::report::{Outcome, Report, Row, SceneReport, Skipped};
use super::scan::ScannedSkin;
use super::truth::{TruthRequest, is_in_contact, itself};
use super::variant::{Materials, Study, StudyScene, Truth, Variant};
use crate::mesh::Warning;
use crate::prediction::{Plan, Scene, Settings, Skin, points_refined};
use crate::progress::Progress;
use std::collections::{BTreeMap, BTreeSet};

/// The code of rows that were not begun, because the time of the study was used up.
pub const NOT_RUN: &str = "not-run";

/// The share of the error of a truth below which an answer differs from it by rounding.
const ROUNDING: f64 = 1e-6;

/// Why an answer whose model was chosen has no row.
const CHOSE_THE_TRUTH: &str =
    "the model that was chosen is the truth itself, on its mesh: what it is off by is not known";

/// Runs every scene with every plan, material, level and variant. The same study gives the same report but for times
/// and memory. Combinations that are the truth themselves have no row, nor have variants that do not serve a scene: both are named
/// as skipped.
pub fn run(
    study: &Study,
    stopwatch: &dyn Stopwatch,
    progress: &dyn Progress,
) -> Result<Report, StudyError> {
    check(study)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let Study { repeats, row_s, .. } = *study;
    let bench = Bench { pool, repeats, row_s, stopwatch, progress };
    let begun = stopwatch.seconds();
    let mut report = Report::default();
    for (place, scene) in study.scenes.iter().enumerate() {
        let work = SceneWork { study, place, scene, bench: &bench, begun };
        let (about, rows, skipped) = work.run()?;
        report.scenes.push(about);
        report.rows.extend(rows);
        report.skipped.extend(skipped);
    }
    Ok(report)
}

/// An empty study is an error, and so are two things of one name: rows could not be distinguished.
fn check(study: &Study) -> Result<(), StudyError> {
    distinct("scene", study.scenes.iter().map(|scene| scene.name.clone()))?;
    distinct("variant", study.variants.iter().map(|variant| variant.label.clone()))?;
    distinct("level", study.levels.iter().map(u32::to_string))?;
    for scene in &study.scenes {
        distinct("plan", scene.plans.iter().map(|(name, _)| name.clone()))?;
        distinct("material", scene.materials.iter().map(|materials| materials.name.clone()))?;
    }
    if study.repeats == 0 { Err(StudyError::Empty { what: "repeat" }) } else { Ok(()) }
}

fn distinct(what: &'static str, names: impl Iterator<Item = String>) -> Result<(), StudyError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if seen.contains(&name) {
            return Err(StudyError::Repeated { what, name });
        }
        seen.insert(name);
    }
    if seen.is_empty() { Err(StudyError::Empty { what }) } else { Ok(()) }
}

/// Variants that took too long at a level, and the reason for their further rows, which are skipped.
type OverdueVariants<'a> = BTreeMap<(u32, &'a str), Refusal>;

/// The rows of one scene.
struct SceneWork<'a> {
    study: &'a Study,
    /// Of the scene among those of the study.
    place: usize,
    scene: &'a StudyScene,
    bench: &'a Bench<'a>,
    /// When the study began, in s of the stopwatch.
    begun: f64,
}

/// Outcome of one combination.
struct Attempt<'a> {
    level: u32,
    variant: &'a Variant,
    answer: Result<Answer, Refusal>,
}

impl<'a> SceneWork<'a> {
    fn run(&self) -> Result<(SceneReport, Vec<Row>, Vec<Skipped>), StudyError> {
        // 1. The skin that errors are measured on.
        let mut levels = Levels::of(self.scene);
        let of_plans = self.scene.plans.iter().map(|plan| self.at_rest(&mut levels, plan));
        let (skins, points): (Vec<Result<Skin, Refusal>>, Vec<Option<Warning>>) = of_plans.unzip();

        // 2. What the methods answer, for each plan and material.
        let mut attempts = Vec::new();
        let (mut late, mut skipped) = (OverdueVariants::new(), Vec::new());
        for (plan, known) in self.scene.plans.iter().zip(skins.iter().zip(&points)) {
            for materials in &self.scene.materials {
                let found = self.attempts(&mut levels, &mut late, (plan, materials), known)?;
                skipped.extend(found.1);
                attempts.push(found.0);
            }
        }

        // 3. What is true.
        let begin = self.bench.stopwatch.seconds();
        let asked =
            TruthRequest { scene: self.scene, skins: &skins, progress: self.bench.progress };
        let wanted = [false, true].map(|contact| {
            let answered = attempts.iter().flatten().filter(|attempt| attempt.answer.is_ok());
            answered.into_iter().any(|own| is_in_contact(self.scene, own.variant) == contact)
        });
        let truths = SceneTruths::find(&asked, &mut levels, wanted)?;
        let truth_s = self.bench.stopwatch.seconds() - begin;

        // 4. How far apart they are.
        let (mut rows, mut of_scan) = (Vec::new(), OfScan::default());
        let farthest = self.farthest(&attempts);
        let mut attempts = attempts.into_iter();
        let plans = self.scene.plans.iter().zip(&skins).zip(&farthest);
        for (of_plan, (((plan, _), skin), farthest)) in plans.enumerate() {
            let scanned = self.scanned(skin, farthest);
            for (place, materials) in self.scene.materials.iter().enumerate() {
                let truth = match &scanned {
                    Some(scanned) => TrueSkins::Scanned(scanned),
                    None => truths.of(self.scene, skin, (of_plan, place)),
                };
                for attempt in attempts.next().into_iter().flatten() {
                    match self.row(plan, materials, attempt, &truth) {
                        Ok(row) => rows.push(row),
                        Err(none) => skipped.push(none),
                    }
                }
            }
            if let Some(Ok(scanned)) = scanned {
                of_scan = OfScan::of(scanned, &rows);
            }
        }
        if self.bench.progress.is_cancelled() {
            return Err(StudyError::Cancelled);
        }
        let about = SceneReport {
            name: self.scene.name.clone(),
            nodes: self.scene.case.volume.nodes.len(),
            cells: self.scene.case.volume.cells.len(),
            cell_size: cell_size(&self.scene.case.volume),
            skin_nodes: skins.iter().flatten().map(|skin| skin.nodes().len()).next().unwrap_or(0),
            truth: of_scan.about.unwrap_or(truths.words),
            truth_error_mm: truths.error_mm,
            unmoved_mm: of_scan.unmoved,
            noise_mm: of_scan.noise,
            warnings: of_scan.warnings.into_iter().chain(points.into_iter().flatten()).collect(),
            truth_s,
        };
        Ok((about, rows, summed(skipped)))
    }

    /// The skin as its scan is measured from it, where a scan is the truth.
    fn scanned<'s>(
        &'s self,
        skin: &'s Result<Skin, Refusal>,
        farthest: &[f64],
    ) -> Option<Result<ScannedSkin<'s>, Refusal>> {
        let Truth::Scan(scan) = &self.scene.truth else { return None };
        Some(ScannedSkin::of(skin, scan, farthest, self.bench.progress))
    }

    /// For each plan how far any answer moves each point of the skin, in mm.
    fn farthest(&self, attempts: &[Vec<Attempt>]) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for of_plan in attempts.chunks(self.scene.materials.len().max(1)) {
            let mut farthest = Vec::new();
            for answer in of_plan.iter().flatten().filter_map(|of| of.answer.as_ref().ok()) {
                farthest.resize(answer.displacement.len(), 0.0_f64);
                for (most, u) in farthest.iter_mut().zip(&answer.displacement) {
                    *most = most.max(u.norm());
                }
            }
            all.push(farthest);
        }
        all
    }

    /// The skin of a plan at level 0, and the warning where finer meshes keep points of it.
    fn at_rest(
        &self,
        levels: &mut Levels,
        (name, plan): &(String, Plan),
    ) -> (Result<Skin, Refusal>, Option<Warning>) {
        let scene = match self.at_level_0(levels, plan) {
            Ok(scene) => scene,
            Err(refusal) => return (Err(refusal), None),
        };
        let is_refined = matches!(self.scene.truth, Truth::Refined { times: 1.., .. })
            || self.study.levels.iter().any(|level| *level > 0);
        // A cell without volume is refused where it is solved.
        let points = is_refined.then(|| points_refined(&scene).ok().flatten()).flatten();
        let of_plan =
            |told: Warning| Warning { detail: format!("plan {name:?}: {}", told.detail), ..told };
        (Ok(scene.skin), points.map(of_plan))
    }

    fn at_level_0(&self, levels: &mut Levels, plan: &Plan) -> Result<Scene, Refusal> {
        let materials = self.scene.materials.first();
        let materials = materials.ok_or_else(|| Refusal::new("missing-material", "no material"))?;
        let case = levels.case(0, materials)?;
        Scene::new(&case, plan, &Settings::default()).map_err(|errors| Refusal::from(&errors))
    }

    fn attempts(
        &self,
        levels: &mut Levels,
        late: &mut OverdueVariants<'a>,
        ((name, plan), materials): (&(String, Plan), &Materials),
        (skin, points): (&Result<Skin, Refusal>, &Option<Warning>),
    ) -> Result<(Vec<Attempt<'a>>, Vec<Skipped>), StudyError> {
        let (mut attempts, mut skipped) = (Vec::new(), Vec::new());
        let mut unserved: Vec<Skipped> = Vec::new();
        for &level in &self.study.levels {
            for variant in self.study.variants_of(self.place) {
                if self.bench.progress.is_cancelled() {
                    return Err(StudyError::Cancelled);
                }
                let before = unserved.iter().find(|other| other.label == variant.label).cloned();
                let truth = || itself(self.scene, variant, level);
                if let Some(none) = before.or_else(|| Some(self.skipped(variant, truth()?))) {
                    skipped.push(none);
                    continue;
                }
                if let Some(before) = late.get(&(level, variant.label.as_str())) {
                    attempts.push(Attempt { level, variant, answer: Err(before.clone()) });
                    continue;
                }
                let answer = self.attempt(levels, (level, materials), plan, (variant, skin));
                attempts.push(match answer.map(|answer| answer.told(level, points)) {
                    Ok(answer) => Attempt { level, variant, answer: Ok(answer) },
                    Err(NoAnswer::Refused(why)) => Attempt { level, variant, answer: Err(why) },
                    Err(NoAnswer::Unserved(reason)) => {
                        unserved.push(self.skipped(variant, reason));
                        skipped.extend(unserved.last().cloned());
                        continue;
                    }
                    Err(NoAnswer::Late(why)) => {
                        let detail = format!("not tried: {} with plan {name:?}", why.detail);
                        let after = Refusal::new(&why.code, detail);
                        late.insert((level, &variant.label), after);
                        Attempt { level, variant, answer: Err(why) }
                    }
                    Err(NoAnswer::Cancelled) => return Err(StudyError::Cancelled),
                });
            }
        }
        Ok((attempts, skipped))
    }

    fn skipped(&self, variant: &Variant, reason: String) -> Skipped {
        Skipped {
            scene: self.scene.name.clone(),
            method: variant.method.clone(),
            label: variant.label.clone(),
            reason,
            rows: 1,
        }
    }

    fn attempt(
        &self,
        levels: &mut Levels,
        (level, materials): (u32, &Materials),
        plan: &Plan,
        (variant, skin): (&Variant, &Result<Skin, Refusal>),
    ) -> Result<Answer, NoAnswer> {
        if self.bench.stopwatch.seconds() - self.begun > self.study.budget_s {
            let detail = format!("the {} s of the study were used up", self.study.budget_s);
            return Err(Refusal::new(NOT_RUN, detail).into());
        }
        let skin = skin.as_ref().map_err(Refusal::clone)?;
        let case = levels.case(level, materials)?;
        self.bench.answer(&case, &levels.plan(plan, materials), variant, skin.nodes())
    }

    /// The row of an answer, or why it has none.
    fn row(
        &self,
        plan: &str,
        materials: &Materials,
        attempt: Attempt,
        truth: &TrueSkins,
    ) -> Result<Row, Skipped> {
        let Attempt { level, variant, answer } = attempt;
        let element = answer.as_ref().map_or_else(|_| String::new(), |a| a.elements.clone());
        let outcome = match answer.and_then(|answer| truth.judge(variant, answer)) {
            Ok(solved) => Outcome::Solved(Box::new(solved)),
            Err(Refusal { code, detail }) => Outcome::Failed { code, detail },
        };
        if is_of_the_truth(&outcome) {
            return Err(self.skipped(variant, CHOSE_THE_TRUTH.to_owned()));
        }
        Ok(Row {
            scene: self.scene.name.clone(),
            plan: plan.to_owned(),
            method: variant.method.clone(),
            label: variant.label.clone(),
            element,
            material: materials.name.clone(),
            level,
            outcome,
        })
    }
}

/// Whether a model was chosen that is the one that is held for true, on its mesh: what its error would be is not known.
fn is_of_the_truth(outcome: &Outcome) -> bool {
    let Outcome::Solved(solved) = outcome else { return false };
    let is_same = |[own, _]: [f64; 2]| solved.error.mean <= ROUNDING * own;
    solved.chosen.is_some() && solved.truth_error.is_some_and(is_same)
}

/// Each once, with the rows of all that are alike.
fn summed(skipped: Vec<Skipped>) -> Vec<Skipped> {
    let mut all: Vec<Skipped> = Vec::new();
    for one in skipped {
        let is_like =
            |other: &&mut Skipped| (&other.label, &other.reason) == (&one.label, &one.reason);
        match all.iter_mut().find(is_like) {
            Some(other) => other.rows += one.rows,
            None => all.push(one),
        }
    }
    all
}

/// What a report tells of the scan of a scene.
#[derive(Default)]
struct OfScan {
    about: Option<String>,
    unmoved: Option<f64>,
    noise: Option<f64>,
    warnings: Vec<Warning>,
}

impl OfScan {
    fn of(scanned: ScannedSkin, rows: &[Row]) -> Self {
        let unmoved = scanned.unmoved();
        let told = unmoved.as_ref().and_then(|unmoved| scanned.before_operation(unmoved, rows));
        let ScannedSkin { about, noise, mut warnings, .. } = scanned;
        warnings.extend(told);
        let unmoved = unmoved.map(|measured| measured.error.mean);
        OfScan { about: Some(about), unmoved, noise, warnings }
    }
}
