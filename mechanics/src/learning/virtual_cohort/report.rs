//! A virtual cohort to learn from, with what mechanical models say of the same patients.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::classes::{AtThetas, ThetaOfClass, held_out, thetas};
use super::super::cohort::{Cohort, LearningCase};
use super::super::validation::Column;
use super::patient::{Making, VirtualError, VirtualPatient};
use crate::mesh::TriangleSurface;
use crate::prediction::MethodKind;
use crate::progress::{Inner, Progress};
use rayon::prelude::*;

/// Virtual patients, and columns of the table beside what is learned from them.
#[derive(Clone, Debug)]
pub struct VirtualCohort {
    pub cohort: Cohort,
    /// The true displacement, no model, and the mechanical models.
    pub mechanical: Vec<Column>,
    pub thetas: Vec<ThetaOfClass>,
    /// The skin of the first patient at rest.
    pub face: TriangleSurface,
}

/// Makes so many patients, and predicts each.
pub fn virtual_cohort(
    patients: usize,
    making: Making,
    progress: &dyn Progress,
) -> Result<VirtualCohort, VirtualError> {
    let (made, of) = (AtomicUsize::new(0), patients);
    let one = |number| {
        let patient = VirtualPatient::new(number, making, &Inner(progress))?;
        progress.step(made.fetch_add(1, Ordering::Relaxed) + 1, of);
        Ok::<_, VirtualError>(patient)
    };
    let patients = (0..patients).into_par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let cases = (0..).zip(&patients).map(|(number, own)| case(number, own)).collect();
    let regions = patients.first().map(|own| own.regions.clone()).unwrap_or_default();
    Ok(report(Cohort::new(cases, regions, MethodKind::FemLinear.name())?, &patients))
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

fn report(cohort: Cohort, patients: &[VirtualPatient]) -> VirtualCohort {
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
    let face = patients.first().map(|own| own.face.clone()).unwrap_or_default();
    VirtualCohort { mechanical, thetas: thetas(&cohort, &told), cohort, face }
}
