//! Outcome of a study: its rows against thresholds, and against the same rows of an earlier study.

use std::collections::BTreeMap;

use crate::schema::study::document::{ThresholdsDocument, TolerancesDocument};
use crate::schema::study::report::{
    FailingRowDocument, NumbersDocument, OutcomeName, ReportDocument, RowDocument, RowStatus,
    RowVerdict, RulesDocument, StudySceneDocument, VerdictDocument,
};
use mechanics::plan::doubt::NOTHING_MOVES;

/// Negligible differences, independent of the ratios: errors in mm to which solutions agree, iterations by which the
/// rounding of another processor's factorisation may change their number, and the jitter of clocks in s.
const NO_ERROR_MM: f64 = 1e-4;
const NO_ITERATIONS: f64 = 5.0;
const NO_TIME_S: f64 = 0.02;

/// Measures of rows.
const MEAN: &str = "mean_mm";
const P95: &str = "p95_mm";
const WALL: &str = "wall_s";

/// An earlier study to compare rows with.
pub enum Baseline<'a> {
    /// None was requested.
    NotAsked,
    /// One was requested, and is missing: why, in words.
    Missing(String),
    Report(&'a ReportDocument),
}

/// The same row in another study.
type RowKey<'a> = (&'a str, &'a str, &'a str, u32, &'a str);

fn place(row: &RowDocument) -> RowKey<'_> {
    (&row.scene, &row.plan, &row.material, row.level, &row.label)
}

/// Judges every row and the whole by the rules of the report.
pub fn judge(report: &mut ReportDocument, baseline: &Baseline) {
    let before: BTreeMap<RowKey, &RowDocument> = match baseline {
        Baseline::Report(earlier) => earlier.rows.iter().map(|row| (place(row), row)).collect(),
        Baseline::NotAsked | Baseline::Missing(_) => BTreeMap::new(),
    };
    let rules = report.rules.clone();
    let scenes = &report.scenes;
    let mut failing = Vec::new();
    for row in &mut report.rows {
        let answers_the_same = |_: &&RowDocument| match baseline {
            Baseline::Report(earlier) => is_same_question(row, scenes, earlier),
            Baseline::NotAsked | Baseline::Missing(_) => false,
        };
        let earlier = before.get(&place(row)).copied().filter(answers_the_same);
        let (verdict, found) = judge_row(row, earlier, &rules);
        if matches!(verdict, RowVerdict::Worse | RowVerdict::Failed) {
            failing.extend(found.iter().map(|reason| reason.of(row)));
        }
        row.verdict = verdict;
        row.reasons = found.into_iter().map(|reason| reason.words).collect();
    }
    let now: Vec<RowKey> = report.rows.iter().map(place).collect();
    let common = before.keys().filter(|earlier| now.contains(earlier)).count();
    let is_lost = |(place, row): &(&RowKey, &&RowDocument)| {
        !now.contains(place) && (row.status == RowStatus::Solved || !is_skipped(report, row))
    };
    let lost = before.iter().filter(is_lost).count();
    report.verdict = VerdictDocument { failing, ..whole(report, baseline, (common, lost)) };
}

/// Whether the variant of a row is reported not to support its scene.
fn is_skipped(report: &ReportDocument, row: &RowDocument) -> bool {
    report.skipped.iter().any(|skipped| skipped.scene == row.scene && skipped.label == row.label)
}

/// The labels of thresholds without any row, because nothing that they name applies.
fn unheld(report: &ReportDocument) -> Vec<&str> {
    let bounds = report.rules.thresholds.iter().flat_map(|bounds| &bounds.labels);
    let has_row = |label: &str| report.rows.iter().any(|row| row.label == label);
    let is_left_out = |label: &str| report.skipped.iter().any(|skipped| skipped.label == label);
    let labels = bounds.map(String::as_str);
    labels.filter(|label| !has_row(label) && is_left_out(label)).collect()
}

/// Why a row does not pass: in a sentence, with the value and the limit of a measure, if any.
#[derive(Default)]
struct Reason {
    measure: Option<&'static str>,
    value: Option<f64>,
    limit: Option<f64>,
    words: String,
}

impl Reason {
    fn of(&self, row: &RowDocument) -> FailingRowDocument {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        FailingRowDocument {
            scene: row.scene.clone(),
            plan: row.plan.clone(),
            label: row.label.clone(),
            material: row.material.clone(),
            level: row.level,
            measure: self.measure.map(str::to_owned),
            value: finite(self.value),
            limit: finite(self.limit),
            reason: self.words.clone(),
        }
    }
}

impl From<String> for Reason {
    fn from(words: String) -> Self {
        Reason { words, ..Reason::default() }
    }
}

fn judge_row(
    row: &RowDocument,
    before: Option<&RowDocument>,
    rules: &RulesDocument,
) -> (RowVerdict, Vec<Reason>) {
    let numbers = match (row.status, &row.numbers) {
        (RowStatus::NotRun, _) => return (RowVerdict::NotRun, vec![not_run(row).into()]),
        (RowStatus::Solved, Some(numbers)) => numbers,
        _ => return failed(row, before, rules),
    };
    if row.warnings.iter().any(|code| code == NOTHING_MOVES) {
        let why = "its plan moves nothing, and every method solves that without error".to_owned();
        return (RowVerdict::Failed, vec![why.into()]);
    }
    let mut reasons = Vec::new();
    if let Some(thresholds) = &rules.thresholds {
        reasons.extend(above(row, numbers, thresholds));
    }
    if let Some(earlier) = before.and_then(|row| row.numbers.as_ref()) {
        reasons.extend(grown(numbers, earlier, &rules.tolerances));
    }
    let verdict = if reasons.is_empty() { RowVerdict::Pass } else { RowVerdict::Worse };
    (verdict, reasons)
}

fn not_run(row: &RowDocument) -> String {
    row.error.as_ref().map_or_else(|| "did not run".to_owned(), |error| error.detail.clone())
}

fn failed(
    row: &RowDocument,
    before: Option<&RowDocument>,
    rules: &RulesDocument,
) -> (RowVerdict, Vec<Reason>) {
    let kind = row.error.as_ref().map_or("unknown", |error| error.kind.as_str());
    let detail = row.error.as_ref().map_or("", |error| error.detail.as_str());
    if rules.expected_failures.contains(&row.label) {
        return (RowVerdict::KnownFailure, vec![format!("may fail: {kind}: {detail}").into()]);
    }
    let earlier = before.and_then(|row| row.error.as_ref());
    if earlier.is_some_and(|earlier| earlier.kind == kind) {
        let words = format!("as in the baseline: {kind}: {detail}");
        return (RowVerdict::KnownFailure, vec![words.into()]);
    }
    let solved_before = before.is_some_and(|row| row.status == RowStatus::Solved);
    let words = if solved_before { "solved in the baseline, now " } else { "" };
    (RowVerdict::Failed, vec![format!("{words}{kind}: {detail}").into()])
}

/// The thresholds that a row exceeds.
fn above(row: &RowDocument, numbers: &NumbersDocument, bounds: &ThresholdsDocument) -> Vec<Reason> {
    if !bounds.labels.is_empty() && !bounds.labels.contains(&row.label) {
        return Vec::new();
    }
    let measured = [
        (MEAN, "mean error", numbers.mean_mm, bounds.mean_mm, "mm"),
        (P95, "p95 error", numbers.p95_mm, bounds.p95_mm, "mm"),
        (WALL, "wall time", numbers.wall_s, bounds.wall_s, "s"),
    ];
    let exceeds = measured.into_iter().filter_map(|(measure, name, value, bound, unit)| {
        let bound = bound.filter(|&bound| value > bound)?;
        let words = format!("{name} {value:.4} {unit} is above the threshold {bound} {unit}");
        Some(Reason { measure: Some(measure), value: Some(value), limit: Some(bound), words })
    });
    exceeds.collect()
}

/// Regressions against the same row before.
fn grown(
    now: &NumbersDocument,
    before: &NumbersDocument,
    tolerances: &TolerancesDocument,
) -> Vec<Reason> {
    let growth = |measure, name, unit, digits, slack| Growth { measure, name, unit, digits, slack };
    let error = growth(P95, "p95 error", " mm", 4, NO_ERROR_MM);
    let iterations = growth("iterations", "iterations", "", 0, NO_ITERATIONS);
    let time = growth(WALL, "wall time", " s", 4, NO_TIME_S);
    let measured = [
        error.beyond(now.p95_mm, before.p95_mm, Some(tolerances.p95_ratio)),
        iterations.beyond(
            now.iterations as f64,
            before.iterations as f64,
            Some(tolerances.iterations_ratio),
        ),
        time.beyond(now.wall_s, before.wall_s, tolerances.wall_ratio),
    ];
    measured.into_iter().flatten().collect()
}

/// A number of a row that may grow.
struct Growth {
    /// Its name in documents.
    measure: &'static str,
    name: &'static str,
    unit: &'static str,
    digits: usize,
    /// A negligible difference.
    slack: f64,
}

impl Growth {
    /// The sentence if it grew by more than is allowed; without a ratio it is not judged.
    fn beyond(&self, now: f64, before: f64, ratio: Option<f64>) -> Option<Reason> {
        let Growth { measure, name, unit, digits, slack } = *self;
        let of = |limit, words| Reason { measure: Some(measure), value: Some(now), limit, words };
        if ratio.is_some() && !before.is_finite() {
            return Some(of(None, format!("{name} of the baseline is not a number")));
        }
        let ratio = ratio.filter(|ratio| now > before * ratio && now > before + slack)?;
        let times = now / before;
        let words = format!(
            "{name} {now:.digits$}{unit} is {times:.2} times the {before:.digits$}{unit} of the baseline, {ratio} are allowed"
        );
        Some(of(Some(f64::max(before * ratio, before + slack)), words))
    }
}

/// The mesh and the truth of a scene, in words.
fn question(scene: &StudySceneDocument) -> String {
    let StudySceneDocument { nodes, cells, truth, .. } = scene;
    format!("{nodes} nodes, {cells} cells and the truth {truth:?}")
}

/// Whether a row has the same mesh, case, reference and movement as the row of the same names in the baseline.
fn is_same_question<'a>(
    row: &RowDocument,
    scenes: &'a [StudySceneDocument],
    earlier: &'a ReportDocument,
) -> bool {
    let find =
        |scenes: &'a [StudySceneDocument]| scenes.iter().find(|scene| scene.name == row.scene);
    let (Some(now), Some(then)) = (find(scenes), find(&earlier.scenes)) else { return true };
    let plan = |scene: &'a StudySceneDocument| scene.plans.get(&row.plan);
    question(now) == question(then)
        && is_alike(now.case.as_ref(), then.case.as_ref())
        && is_alike(plan(now), plan(then))
}

/// Whether two hashes are equal, as far as both are known: earlier versions wrote fewer.
fn is_alike(now: Option<&String>, then: Option<&String>) -> bool {
    now == then || now.is_none() || then.is_none()
}

/// Scenes of one name that differ in the baseline: their rows are not comparable.
fn other_questions(report: &ReportDocument, earlier: &ReportDocument) -> Vec<String> {
    let pair = |scene: &StudySceneDocument| {
        let before = earlier.scenes.iter().find(|other| other.name == scene.name)?;
        let name = &scene.name;
        if question(scene) != question(before) {
            let (now, then) = (question(scene), question(before));
            return Some(format!(
                "the scene {name:?} has {now}, and in the baseline {then}: their rows cannot be compared"
            ));
        }
        let words = format!(
            "the case of the scene {name:?} has another document or mesh than in the baseline: their rows cannot be \
             compared"
        );
        (!is_alike(scene.case.as_ref(), before.case.as_ref())).then_some(words)
    };
    let scenes = report.scenes.iter().filter_map(pair);
    scenes.chain(other_plans(report, earlier)).collect()
}

/// Plans of one name with another movement in the baseline.
fn other_plans(report: &ReportDocument, earlier: &ReportDocument) -> Vec<String> {
    let of_scene = |scene: &StudySceneDocument| {
        let before = earlier.scenes.iter().find(|other| other.name == scene.name)?;
        let is_other = |(name, hash): &(&String, &String)| {
            before.plans.get(*name).is_some_and(|other| other != *hash)
        };
        let names: Vec<&str> =
            scene.plans.iter().filter(is_other).map(|(name, _)| name.as_str()).collect();
        let words = format!(
            "{} of the scene {:?} has another movement in the baseline: the rows cannot be compared",
            names.join(", "),
            scene.name
        );
        (!names.is_empty()).then_some(words)
    };
    report.scenes.iter().filter_map(of_scene).collect()
}

fn whole(
    report: &ReportDocument,
    baseline: &Baseline,
    (common, lost): (usize, usize),
) -> VerdictDocument {
    let count = |verdict| report.rows.iter().filter(|row| row.verdict == verdict).count();
    let of_status = |status| report.rows.iter().filter(|row| row.status == status).count();
    let (worse, failed) = (count(RowVerdict::Worse), count(RowVerdict::Failed));
    let (solved, not_run) = (of_status(RowStatus::Solved), count(RowVerdict::NotRun));
    let rows = report.rows.len();
    let mut found = Vec::new();
    let mut tell = |outcome, holds: bool, words: String| {
        if holds {
            found.push((outcome, words));
        }
    };
    tell(OutcomeName::Worse, worse > 0, format!("{worse} of {rows} row(s) worse than allowed"));
    tell(OutcomeName::Worse, failed > 0, format!("{failed} of {rows} row(s) failed"));
    tell(OutcomeName::Incomplete, solved == 0, "no row was solved".to_owned());
    let unheld = unheld(report);
    let words = format!("the thresholds are for {}, which applies nowhere", unheld.join(", "));
    tell(OutcomeName::Incomplete, !unheld.is_empty(), words);
    tell(OutcomeName::Incomplete, not_run > 0, format!("{not_run} of {rows} rows did not run"));
    let words = format!("{lost} rows of the baseline are not in this study");
    tell(OutcomeName::Incomplete, lost > 0 && common > 0, words);
    match baseline {
        Baseline::Missing(why) => tell(OutcomeName::NoBaseline, true, why.clone()),
        Baseline::Report(earlier) => {
            let words = "the baseline has no row in common with this study".to_owned();
            tell(OutcomeName::NoBaseline, common == 0, words);
            for words in other_questions(report, earlier) {
                tell(OutcomeName::Incomplete, true, words);
            }
        }
        Baseline::NotAsked => {}
    }
    // The first is the gravest: what is worse is worse, however much did not run.
    let outcome = found.first().map_or(OutcomeName::Pass, |(outcome, _)| *outcome);
    let baseline = match baseline {
        Baseline::Report(earlier) => earlier.job.clone(),
        Baseline::NotAsked | Baseline::Missing(_) => None,
    };
    VerdictDocument {
        outcome,
        reasons: found.into_iter().map(|(_, words)| words).collect(),
        rows: rows as u64,
        solved: solved as u64,
        failed: of_status(RowStatus::Failed) as u64,
        worse: worse as u64,
        not_run: not_run as u64,
        skipped: report.skipped.iter().map(|skipped| skipped.rows).sum(),
        baseline,
        failing: Vec::new(),
    }
}
