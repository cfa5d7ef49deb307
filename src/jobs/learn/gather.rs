//! The cohort of a job: its cases predicted once more for their stress, and what was measured of them.

use std::collections::BTreeMap;

use super::corresponding::{corresponds, measured, predicted_alike};
use super::input::LearnInput;
use super::thetas::at_thetas;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::fetch;
use crate::jobs::made::{refused_cohort, refused_material, refused_virtual};
use crate::jobs::output::JobContext;
use crate::jobs::predict::Prepared;
use crate::schema::Pointer;
use crate::schema::learn::correspondence::CorrespondenceDocument;
use crate::schema::learn::mechanics::MechanicsDocument;
use crate::schema::learn::result::MadeCohortDocument;
use crate::schema::predict::result::InputDocument;
use mechanics::learning::classes::{AtThetas, ThetaOfClass, held_out, thetas};
use mechanics::learning::validation::Column;
use mechanics::learning::virtual_cohort::{Making, VirtualCohort, supposed, virtual_cohort};
use mechanics::learning::{Cohort, LearningCase, measures};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};
use mechanics::prediction::{Scene, Skin, displacement};
use mechanics::progress::{Progress, StopQuery};
use mechanics::validation::operated::{OperatedSkin, suspicions, unlike_skins};

/// What is learned from, and the columns of the table that are not learned.
pub struct Gathered {
    pub cohort: Cohort,
    /// The mechanical prediction is among them, called by its method.
    pub mechanical: Vec<Column>,
    pub thetas: Vec<ThetaOfClass>,
    pub inputs: Vec<InputDocument>,
    pub frame: Frame,
    /// The skin of the first case at rest.
    pub face: TriangleSurface,
    /// Of the meshes of the cases.
    pub correspondence: Option<CorrespondenceDocument>,
    /// Of virtual patients.
    pub made: Option<MadeCohortDocument>,
    /// What each case was predicted by, and its skin at rest.
    pub mechanics: Vec<MechanicsDocument>,
    pub at_rest: Vec<Vec<Vector>>,
    pub warnings: Vec<Warning>,
}

impl Gathered {
    /// What speaks against operated cases; draws of virtual patients do not.
    pub fn suspicions(&self) -> &[Warning] {
        if self.made.is_some() { &[] } else { &self.warnings }
    }
}

pub fn gather(
    input: &LearnInput,
    place: &JobContext,
    clock: &Observed,
) -> Result<Gathered, JobError> {
    match &input.spec.made {
        Some(made) => {
            let making = Making {
                seed: u64::from(made.seed),
                face: made.face.into(),
                fineness: made.fineness() as usize,
                mapping: made.mapping_mm,
            };
            let cohort = virtual_cohort(made.patients as usize, making, clock);
            of_virtual(cohort.map_err(|error| refused_virtual(error, clock))?)
        }
        None => of_cases(input, place, clock),
    }
}

/// Virtual patients, with the mechanics that they are predicted by as real ones have it.
fn of_virtual(made: VirtualCohort) -> Result<Gathered, JobError> {
    let VirtualCohort { cohort, mechanical, thetas, scene, at_rest, contact_areas, redrawn } = made;
    let supposed = supposed().map_err(|error| refused_material(&error))?;
    let mechanics = MechanicsDocument::of_virtual(&scene, &supposed);
    let made = MadeCohortDocument::new(&cohort, contact_areas, &redrawn);
    Ok(Gathered {
        warnings: made.warning().into_iter().collect(),
        made: Some(made),
        mechanics: vec![mechanics; cohort.len()],
        cohort,
        mechanical,
        thetas,
        inputs: Vec::new(),
        frame: Frame::Lps,
        correspondence: Some(CorrespondenceDocument::new(&scene)),
        face: scene.skin.surface,
        at_rest,
    })
}

fn of_cases(
    input: &LearnInput,
    place: &JobContext,
    clock: &Observed,
) -> Result<Gathered, JobError> {
    let mut first: Option<Prepared> = None;
    let (mut members, mut inputs, mut told): (Vec<Member>, Vec<_>, Vec<_>) = Default::default();
    for (index, learned_from) in input.cases.iter().enumerate() {
        let at = Pointer::root().key("spec").key("cases").index(index);
        learned_from.check_settings(&at.key("prediction"))?;
        let prediction = &learned_from.prediction;
        let prepare = |stop: &StopQuery| prediction.prepare(place.sources, place.limits, stop);
        let prepared = clock.prepared(prepare)?;
        prepared.admit(0, place.limits)?;
        corresponds(first.as_ref().unwrap_or(&prepared), &prepared, &at)?;
        let stated = input.spec.cases.get(index);
        let id = stated.map(|case| case.actual.as_str()).unwrap_or_default();
        let actual = fetch(place.sources, id, &at.key("actual"))?;
        let name = input.spec.name(index);
        inputs.push(actual.to_input(&format!("actual {name}")));
        let matrix = stated.and_then(|case| case.matrix4x4);
        let after = measured(&actual, matrix, &prepared, &at.key("actual"))?;
        let mechanics = learned_from.prediction.mechanics(&prepared.plan, &prepared.scene);
        predicted_alike(members.first().map_or(&mechanics, |own| &own.mechanics), &mechanics, &at)?;
        let class = input.spec.class(index, prepared.plan.segments.len());
        let (case, skin) = learned([name, class], &prepared.scene, after, clock)?;
        members.push(Member { case, skin, mechanics });
        if input.spec.theta {
            told.push(at_thetas(&prepared, &at.key("prediction"), clock)?);
        }
        clock.step(index + 1, input.cases.len());
        clock.check()?;
        first.get_or_insert(prepared);
    }
    let found = gathered(input, members, &told, first)?;
    Ok(Gathered { inputs, ..found })
}

/// A case that is learned from, and what speaks against it.
struct Member {
    case: LearningCase,
    skin: OperatedSkin,
    mechanics: MechanicsDocument,
}

fn gathered(
    input: &LearnInput,
    members: Vec<Member>,
    told: &[AtThetas],
    first: Option<Prepared>,
) -> Result<Gathered, JobError> {
    let correspondence = first.as_ref().map(|own| CorrespondenceDocument::new(&own.scene));
    let nothing = (TriangleSurface::default(), BTreeMap::new(), Frame::Unspecified);
    let (face, regions, frame) = first.map_or(nothing, |own| {
        let Skin { surface, regions, .. } = own.scene.skin;
        (surface, regions, own.case.frame)
    });
    let (mut cases, mut skins, mut mechanics) = (Vec::new(), Vec::new(), Vec::new());
    for Member { case, skin, mechanics: own } in members {
        cases.push(case);
        skins.push(skin);
        mechanics.push(own);
    }
    let cohort = Cohort::new(cases, regions, &input.predicted_by());
    let cohort = cohort.map_err(|error| refused_cohort(&error))?;
    let column = |name: &str, of: &dyn Fn(&LearningCase) -> Vec<f64>| {
        let told: Vec<Vec<f64>> = cohort.cases.iter().map(of).collect();
        Column::of(name, &told, &cohort)
    };
    let mut mechanical = vec![
        column("no movement", &|case| vec![0.0; case.actual.len()]),
        column(&cohort.mechanical, &|case| case.predicted.clone()),
    ];
    let mut fitted = Vec::new();
    if input.spec.theta {
        mechanical.push(held_out(&cohort, told));
        fitted = thetas(&cohort, told);
    }
    let warnings = doubts(input, &cohort, &skins);
    let at_rest = skins.into_iter().map(|own| own.at_rest).collect();
    Ok(Gathered {
        cohort,
        made: None,
        mechanical,
        thetas: fitted,
        inputs: Vec::new(),
        frame,
        face,
        correspondence,
        mechanics,
        at_rest,
        warnings,
    })
}

/// What speaks against measured skins and meshes, each with the place of its case.
fn doubts(input: &LearnInput, cohort: &Cohort, skins: &[OperatedSkin]) -> Vec<Warning> {
    let list = if input.cohort.is_some() { "/spec/cohort/members" } else { "/spec/cases" };
    let of = |place: usize| {
        let rest = |other: usize| skins[other].at_rest.as_slice();
        let others: Vec<&[Vector]> = cohort.others(place).into_iter().map(rest).collect();
        let mut found = suspicions(place, skins);
        found.extend(unlike_skins(rest(place), &others));
        for warning in &mut found {
            let name = &cohort.cases[place].name;
            warning.detail = format!("{list}/{place} ({name}): {}", warning.detail);
        }
        found
    };
    (0..skins.len()).flat_map(of).collect()
}

fn learned(
    [name, class]: [String; 2],
    scene: &Scene,
    actual: Vec<Vector>,
    clock: &Observed,
) -> Result<(LearningCase, OperatedSkin), JobError> {
    let displacement = displacement(scene, clock).map_err(|error| clock.judge(error))?;
    let at_rest = scene.skin.surface.points.clone();
    let moved = actual.iter().zip(&at_rest).map(|(after, before)| after - before);
    let case = LearningCase {
        name,
        class,
        features: measures::features(scene, &displacement),
        bone: measures::bone(scene, &displacement),
        predicted: measures::skin(scene, &displacement),
        actual: moved.flat_map(|own| [own.x, own.y, own.z]).collect(),
    };
    let predicted = scene.skin.moved(&displacement).points;
    let bone_movement = case.largest_bone_movement();
    Ok((case, OperatedSkin { at_rest, predicted, actual, bone_movement }))
}
