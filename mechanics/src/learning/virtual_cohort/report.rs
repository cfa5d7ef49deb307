//! A virtual cohort to learn from, with what mechanical models say of the same patients.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::classes::{AtThetas, ThetaOfClass, held_out, thetas};
use super::super::cohort::{Cohort, CohortError, LearningCase};
use super::super::validation::Column;
use super::patient::{DrawnPatient, Making, Redrawn, VirtualError, VirtualPatient};
use crate::mesh::Vector;
use crate::prediction::{MethodKind, Scene};
use crate::progress::{Inner, Progress};
use rayon::prelude::*;

/// Virtual patients, and columns of the table beside what is learned from them.
pub struct VirtualCohort {
    pub cohort: Cohort,
    /// The true displacement, no model, and the mechanical models.
    pub mechanical: Vec<Column>,
    pub thetas: Vec<ThetaOfClass>,
    /// What the models see of the first patient; that of the others has the same cells, sets and tissue.
    pub scene: Scene,
    /// The skin of each patient at rest, as it was mapped.
    pub at_rest: Vec<Vec<Vector>>,
    /// Of each patient the area that presses on what it touches in mm2; none where the truth has no contact.
    pub contact_areas: Option<Vec<f64>>,
    pub redrawn: Vec<Redrawn>,
}

/// Makes so many patients, and predicts each.
pub fn virtual_cohort(
    patients: usize,
    making: Making,
    progress: &dyn Progress,
) -> Result<VirtualCohort, VirtualError> {
    let (made, of) = (AtomicUsize::new(0), patients);
    let one = |number| {
        let drawn = DrawnPatient::new(number, making, &Inner(progress))?;
        progress.step(made.fetch_add(1, Ordering::Relaxed) + 1, of);
        let DrawnPatient { patient, scene, redrawn } = drawn;
        // One is enough, and each takes some megabytes.
        Ok::<_, VirtualError>((patient, (number == 0).then_some(scene), redrawn))
    };
    let drawn = (0..patients).into_par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let (mut patients, mut scenes, mut redrawn) = (Vec::new(), Vec::new(), Vec::new());
    for (patient, scene, again) in drawn {
        patients.push(patient);
        scenes.extend(scene);
        redrawn.extend(again);
    }
    let cases = (0..).zip(&patients).map(|(number, own)| case(number, own)).collect();
    let regions = patients.first().map(|own| own.regions.clone()).unwrap_or_default();
    let cohort = Cohort::new(cases, regions, MethodKind::FemLinear.name())?;
    let scene = scenes.pop().ok_or(CohortError::TooFew { cases: 0 })?;
    Ok(report(cohort, &patients, scene, redrawn))
}

fn case(number: usize, patient: &VirtualPatient) -> LearningCase {
    LearningCase {
        name: format!("virtual {}", number + 1),
        class: patient.operation.class.to_owned(),
        features: patient.features.clone(),
        bone: patient.bone.clone(),
        predicted: patient.linear.clone(),
        actual: patient.actual.clone(),
    }
}

fn report(
    cohort: Cohort,
    patients: &[VirtualPatient],
    scene: Scene,
    redrawn: Vec<Redrawn>,
) -> VirtualCohort {
    let column = |name: &str, of: &dyn Fn(&VirtualPatient) -> Vec<f64>| {
        let told: Vec<Vec<f64>> = patients.iter().map(of).collect();
        Column::of(name, &told, &cohort)
    };
    let told: Vec<AtThetas> = patients.iter().map(|own| own.rubin_bodner.clone()).collect();
    let mechanical = vec![
        column("what happened", &|own| own.happened.clone()),
        column("no movement", &|own| vec![0.0; own.actual.len()]),
        column(&cohort.mechanical, &|own| own.linear.clone()),
        column(MethodKind::FemNonlinear.name(), &|own| own.nonlinear.clone()),
        held_out(&cohort, &told),
    ];
    VirtualCohort {
        mechanical,
        thetas: thetas(&cohort, &told),
        cohort,
        scene,
        at_rest: patients.iter().map(|own| own.face.points.clone()).collect(),
        contact_areas: patients.iter().map(|own| own.contact_area).collect(),
        redrawn,
    }
}
