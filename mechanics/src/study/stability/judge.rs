//! Assessment of each probe: solved within its time, and compared with the reference solution.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::{Answer, Axis, AxisMap, Bounds, Finding, Map, Probe, Refusal, Truth, Variant, Verdict};
use crate::mesh::{Vector, Warning};
use crate::prediction::{Laws, ModelError, Prediction, Scene, predict};
use crate::progress::Unobserved;
use crate::solver::SolverError;
use crate::study::deadline::Deadline;
use crate::validation::Statistics;

/// Positions are distinguished down to this, in mm.
const APART: f64 = 1e-4;

/// Every axis with every variant. `told` hears the name of each axis before it is begun.
pub fn map(variants: &[Variant], axes: &[Axis], bounds: &Bounds, told: &dyn Fn(&str)) -> Map {
    let labels = variants.iter().map(|variant| variant.label.clone()).collect();
    let axes = axes.iter().map(|axis| {
        told(axis.title);
        sweep(axis, variants, bounds)
    });
    Map { variants: labels, axes: axes.collect() }
}

fn sweep(axis: &Axis, variants: &[Variant], bounds: &Bounds) -> AxisMap {
    let mut findings: Vec<Vec<Option<Finding>>> = vec![Vec::new(); variants.len()];
    let laws_of = |variant: &Variant| variant.settings.method.properties().laws;
    let mut families: Vec<(Laws, Option<DisplacementByPosition>)> = Vec::new();
    for laws in variants.iter().map(laws_of) {
        if families.iter().all(|(known, _)| *known != laws) {
            families.push((laws, None));
        }
    }
    for (value, _) in &axis.values {
        let truths = families.iter_mut().filter_map(|(laws, first)| {
            Some((*laws, ReferenceAnswer::of(axis.truth_of(*value, *laws)?, first)))
        });
        let truths: Vec<(Laws, ReferenceAnswer)> = truths.collect();
        for (row, variant) in findings.iter_mut().zip(variants) {
            let truth = truths.iter().find(|(laws, _)| *laws == laws_of(variant));
            row.push(truth.and_then(|(_, truth)| match (axis.probe)(*value, variant) {
                Ok(None) => None,
                Ok(Some(probe)) => Some(judged(&probe, truth, axis.bound_mm, bounds)),
                Err(refusal) => Some(refused(refusal)),
            }));
        }
    }
    AxisMap {
        name: axis.name,
        title: axis.title,
        unit: axis.unit,
        scene: axis.scene,
        reference: axis.reference,
        bound_mm: axis.bound_mm,
        values: axis.values.clone(),
        findings,
    }
}

/// Displacement by place.
type DisplacementByPosition = Rc<BTreeMap<[i64; 3], Vector>>;

/// The right answer, solved where it had to be.
enum ReferenceAnswer {
    Formula(Box<dyn Fn(&Vector) -> Vector + Send + Sync>),
    Solved { answer: DisplacementByPosition, times: f64 },
    Impossible,
}

impl ReferenceAnswer {
    /// `first` keeps what was solved for the first value of an axis.
    fn of(truth: Truth, first: &mut Option<DisplacementByPosition>) -> Self {
        let (answer, times) = match truth {
            Truth::Formula(formula) => return ReferenceAnswer::Formula(formula),
            Truth::Impossible => return ReferenceAnswer::Impossible,
            Truth::First { times } => (first.clone(), times),
            Truth::Solved(probe) => (solve(&probe), 1.0),
        };
        first.clone_from(&answer);
        answer
            .map_or(ReferenceAnswer::Impossible, |answer| ReferenceAnswer::Solved { answer, times })
    }

    fn at(&self, point: &Vector) -> Option<Vector> {
        match self {
            ReferenceAnswer::Formula(formula) => Some(formula(point)),
            ReferenceAnswer::Solved { answer, times } => {
                answer.get(&place(point)).map(|u| u * *times)
            }
            ReferenceAnswer::Impossible => None,
        }
    }
}

fn place(point: &Vector) -> [i64; 3] {
    [point.x, point.y, point.z].map(|c| (c / APART).round() as i64)
}

fn solve(probe: &Probe) -> Option<DisplacementByPosition> {
    let scene = Scene::new(&probe.case, &probe.plan, &probe.settings).ok()?;
    let answer = predict(&scene, &Unobserved).ok()?;
    Some(Rc::new(probe.case.volume.nodes.iter().map(place).zip(answer.displacement).collect()))
}

fn judged(probe: &Probe, truth: &ReferenceAnswer, bound_mm: f64, bounds: &Bounds) -> Finding {
    let scene = match Scene::new(&probe.case, &probe.plan, &probe.settings) {
        Ok(scene) => scene,
        Err(errors) => {
            let first = errors.0.into_iter().next();
            return refused(first.map_or_else(
                || Refusal::new("", "refused", "no reason was given"),
                |error| Refusal::new(&error.pointer, error.code.name(), &error.detail),
            ));
        }
    };
    let deadline = Deadline::after(bounds.seconds, bounds.stopwatch, &Unobserved);
    match predict(&scene, &deadline) {
        Err(ModelError::Solver(SolverError::Stopped)) => {
            let detail = format!("not done after {} s", bounds.seconds);
            failed(Refusal::new("", "budget-exceeded", &detail))
        }
        Err(error) => failed(Refusal::new("", error.code(), &error.to_string())),
        Ok(prediction) => answered(&scene, prediction, truth, bound_mm),
    }
}

fn answered(
    scene: &Scene,
    prediction: Prediction,
    truth: &ReferenceAnswer,
    bound_mm: f64,
) -> Finding {
    let answer = measured(scene, prediction, truth);
    // An error that is not a number is beyond any bound.
    let within = answer.error_mm.is_some_and(|error| error <= bound_mm);
    let verdict = match (answer.warnings.is_empty(), within) {
        (false, true) => Verdict::Cautious,
        (false, false) => Verdict::Warned,
        (true, true) => Verdict::Good,
        (true, false) => Verdict::Wrong,
    };
    Finding { verdict, answer: Some(answer), refusal: None }
}

fn measured(scene: &Scene, prediction: Prediction, truth: &ReferenceAnswer) -> Answer {
    let nodes = scene.skin.nodes().iter();
    let errors: Option<Vec<f64>> = nodes
        .map(|&node| {
            let right = truth.at(&scene.mesh.nodes[node as usize])?;
            Some((prediction.displacement[node as usize] - right).norm())
        })
        .collect();
    let areas = scene.skin.surface.point_areas();
    let error_mm = errors.map(|errors| match Statistics::weighted(&errors, &areas) {
        Ok(statistics) => statistics.p95,
        Err(_) => f64::NAN,
    });
    let cells = &prediction.deformation;
    let inverted = cells.iter().filter(|cell| cell.det_f <= 0.0).count();
    Answer {
        error_mm,
        smallest_det_f: cells.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min),
        inverted_share: inverted as f64 / cells.len().max(1) as f64,
        largest_rotation: cells.iter().map(|cell| cell.rotation).fold(0.0, f64::max),
        warnings: of_the_answer(prediction.warnings),
    }
}

/// Warnings of how a scene is stated: they come with every answer, right or wrong.
const OF_THE_SCENE: [&str; 4] =
    ["sliding-beside-segment", "skin-held", "skin-inwards", "skin-unnamed"];

/// Warnings of an answer, without those of its scene.
fn of_the_answer(mut warnings: Vec<Warning>) -> Vec<Warning> {
    warnings.retain(|warning| !OF_THE_SCENE.contains(&warning.code));
    warnings
}

fn refused(refusal: Refusal) -> Finding {
    Finding { verdict: Verdict::Refused, answer: None, refusal: Some(refusal) }
}

fn failed(refusal: Refusal) -> Finding {
    Finding { verdict: Verdict::Failed, ..refused(refusal) }
}

impl Refusal {
    pub(super) fn new(pointer: &str, code: &str, detail: &str) -> Self {
        Refusal { pointer: pointer.to_owned(), code: code.to_owned(), detail: detail.to_owned() }
    }
}
