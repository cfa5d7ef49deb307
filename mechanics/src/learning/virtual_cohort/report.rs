//! A virtual cohort to learn from, with what mechanical models say of the same patients.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::cohort::{Cohort, LearningCase};
use super::super::theta::{Theta, between};
use super::super::validation::{Column, lengths};
use super::patient::{VirtualError, VirtualPatient};
use crate::progress::{Inner, Progress};
use rayon::prelude::*;

/// Theta of one class of surgery, from all its patients.
#[derive(Clone, Debug, PartialEq)]
pub struct ThetaOfClass {
    pub class: String,
    pub patients: usize,
    pub theta: Theta,
}

/// Virtual patients, and columns of the table beside what is learned from them.
#[derive(Clone, Debug)]
pub struct VirtualCohort {
    pub cohort: Cohort,
    /// The true displacement, no model, and the mechanical models.
    pub mechanical: Vec<Column>,
    pub thetas: Vec<ThetaOfClass>,
}

/// Makes so many patients, and predicts each.
pub fn virtual_cohort(
    patients: usize,
    seed: u64,
    fineness: usize,
    progress: &dyn Progress,
) -> Result<VirtualCohort, VirtualError> {
    let (made, of) = (AtomicUsize::new(0), patients);
    let one = |number| {
        let patient = VirtualPatient::new(number, seed, fineness, &Inner(progress))?;
        progress.step(made.fetch_add(1, Ordering::Relaxed) + 1, of);
        Ok::<_, VirtualError>(patient)
    };
    let patients = (0..patients).into_par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let cases = (0..).zip(&patients).map(|(number, own)| case(number, own)).collect();
    let regions = patients.first().map(|own| own.regions.clone()).unwrap_or_default();
    Ok(report(Cohort::new(cases, regions)?, &patients))
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
    let all: Vec<usize> = (0..cohort.len()).collect();
    let with_theta: Vec<Vec<f64>> =
        all.iter().map(|&case| held_out(&cohort, patients, case)).collect();
    let mechanical = vec![
        column("what happened", &|own| own.happened.clone()),
        column("no movement", &|own| vec![0.0; own.actual.len()]),
        column("linear", &|own| own.linear.clone()),
        column("nonlinear", &|own| own.nonlinear.clone()),
        Column::of("Rubin-Bodner", &with_theta, &cohort),
    ];
    VirtualCohort { mechanical, thetas: thetas(&cohort, patients, &all), cohort }
}

/// The prediction of Rubin and Bodner's tissue with the theta of the other patients of the class.
fn held_out(cohort: &Cohort, patients: &[VirtualPatient], case: usize) -> Vec<f64> {
    let class = &cohort.cases[case].class;
    let others = cohort.others(case).into_iter();
    let others: Vec<usize> = others.filter(|&own| cohort.cases[own].class == *class).collect();
    let theta = if others.is_empty() { 1.0 } else { theta(patients, &others).theta };
    with_theta(&patients[case], theta)
}

fn thetas(cohort: &Cohort, patients: &[VirtualPatient], all: &[usize]) -> Vec<ThetaOfClass> {
    let mut classes: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for &case in all {
        classes.entry(&cohort.cases[case].class).or_default().push(case);
    }
    let of = |(class, own): (&str, Vec<usize>)| ThetaOfClass {
        class: class.to_owned(),
        patients: own.len(),
        theta: theta(patients, &own),
    };
    classes.into_iter().map(of).collect()
}

/// The theta with the smallest mean error over some patients.
fn theta(patients: &[VirtualPatient], among: &[usize]) -> Theta {
    Theta::fitted(|theta| {
        let error = |&own: &usize| {
            let lengths = lengths(&with_theta(&patients[own], theta), &patients[own].actual);
            lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
        };
        among.iter().map(error).sum::<f64>() / among.len() as f64
    })
}

fn with_theta(patient: &VirtualPatient, theta: f64) -> Vec<f64> {
    let [low, middle, high] = &patient.rubin_bodner;
    let all = low.iter().zip(middle).zip(high);
    all.map(|((&low, &middle), &high)| between(theta, [low, middle, high])).collect()
}
