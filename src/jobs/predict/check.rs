//! Check of a case and a plan, before anything is solved.

use super::cost;
use super::density::default_density;
use super::input::{PredictInput, Prepared};
use super::overlap::{Collision, collisions, contacts};
use super::planned::{in_numbers, movements, suspect_landmarks};
use crate::jobs::failure::JobError;
use crate::jobs::result::pictures::classes_picture;
use crate::jobs::result::warnings::warnings_after;
use crate::jobs::source::MeshSource;
use crate::schema::Limits;
use crate::schema::case::muscle_mixing::MusclesDocument;
use crate::schema::methods::{WHY_ESTIMATED, WHY_NOT_FORESEEN, WHY_REFINED};
use crate::schema::predict::check::{CheckDocument, ClassCounts, SkinSummary};
use mechanics::mesh::Warning;
use mechanics::prediction::{NodeClass, Scene, landmarks_far};
use mechanics::progress::StopQuery;

/// The counts of a check, and the picture on request: drawing takes longer than counting.
pub struct CheckReport {
    pub document: CheckDocument,
    prepared: Prepared,
}

impl CheckReport {
    /// `classes.svg`: the boundary coloured by node class.
    pub fn picture(&self) -> Result<String, JobError> {
        self.prepared.classes_picture()
    }
}

/// Checks a case and a plan without solving; an empty plan checks the case alone. After a stop it is cancelled.
pub fn check(
    input: &PredictInput,
    sources: &dyn MeshSource,
    limits: &Limits,
    stop: &StopQuery,
) -> Result<CheckReport, JobError> {
    let prepared = input.prepare(sources, limits, stop)?;
    let refine = input.spec.refine.as_ref();
    let refine = refine.map(|own| cost::refined_bound(&prepared.scene, own.cells, limits));
    let document = CheckDocument { refine, ..prepared.summary(input, stop) };
    match stop.is_asked() {
        true => Err(JobError::Cancelled),
        false => Ok(CheckReport { document, prepared }),
    }
}

impl Prepared {
    /// The counts of constrained nodes, and the expected cost of solving; to be dropped after a stop.
    fn summary(&self, input: &PredictInput, stop: &StopQuery) -> CheckDocument {
        let scene = &self.scene;
        let skin = &scene.skin;
        let nodes = scene.mesh.nodes.len();
        let held: usize =
            scene.conditions.constraints.iter().map(|constraint| constraint.count()).sum();
        let collisions = collisions(&self.case, scene, stop);
        let mut of_plan: Vec<Warning> = collisions.iter().filter_map(Collision::warning).collect();
        of_plan.extend(landmarks_far(scene));
        of_plan.extend(suspect_landmarks(&input.case, &self.case));
        of_plan.extend(default_density(input));
        let warnings = self.warnings.iter().chain(&scene.warnings).chain(&of_plan);
        let head = in_numbers(&input.case, &self.case, scene, None);
        CheckDocument {
            nodes: nodes as u64,
            cells: scene.mesh.cells.len() as u64,
            classes: class_counts(scene),
            skin: SkinSummary {
                nodes: skin.surface.points.len() as u64,
                triangles: skin.surface.triangles.len() as u64,
                area_mm2: skin.surface.area(),
                regions: skin
                    .regions
                    .iter()
                    .map(|(name, points)| (name.clone(), points.len() as u64))
                    .collect(),
            },
            repair: self.repair.as_ref().map(Into::into),
            imaged: scene.imaged.as_ref().map(Into::into),
            muscles: MusclesDocument::of(scene),
            unknowns: (3 * nodes - held) as u64,
            memory_mb: cost::memory_mb(scene, 0),
            time_s: cost::time_s(scene, input.spec.method),
            refine: None,
            method: input.spec.method.chosen().name().to_owned(),
            why: self.why(input),
            auto: self.expectation(input),
            movements: movements(scene, self.case.frame),
            collisions: collisions.iter().map(Collision::document).collect(),
            contacts: contacts(&self.case, scene, stop),
            cephalometry: head.measures,
            symmetry: head.symmetry,
            warnings: warnings_after(&self.told, warnings),
        }
    }

    /// Why that method, as far as that is known before anything is solved.
    fn why(&self, input: &PredictInput) -> String {
        let PredictInput { spec, .. } = input;
        match (spec.accepted(), spec.refine.is_some(), self.is_foreseen()) {
            (None, _, _) => spec.method.why().to_owned(),
            (Some(_), true, _) => WHY_REFINED.to_owned(),
            (Some(_), false, true) => WHY_ESTIMATED.to_owned(),
            (Some(_), false, false) => format!("{WHY_ESTIMATED}{WHY_NOT_FORESEEN}"),
        }
    }

    /// The boundary coloured by node class.
    pub fn classes_picture(&self) -> Result<String, JobError> {
        let counts = class_counts(&self.scene);
        let joined: u64 = counts.joined.values().sum();
        let (fixed, sliding) = (counts.fixed, counts.sliding);
        let title = format!(
            "Constraints of the tissue: {joined} joined, {fixed} fixed, {sliding} sliding nodes"
        );
        Ok(classes_picture(&self.scene, self.case.frame, &title)?)
    }
}

fn class_counts(scene: &Scene) -> ClassCounts {
    let mut counts = ClassCounts::default();
    for segment in &scene.segments {
        counts.joined.insert(segment.name.clone(), 0);
    }
    for class in &scene.conditions.classes {
        match class {
            NodeClass::Prescribed => counts.prescribed += 1,
            NodeClass::Joined(segment) => {
                let name = &scene.segments[*segment as usize].name;
                *counts.joined.entry(name.clone()).or_default() += 1;
            }
            NodeClass::Fixed => counts.fixed += 1,
            NodeClass::Sliding => counts.sliding += 1,
            NodeClass::Free => counts.free += 1,
        }
    }
    counts
}
