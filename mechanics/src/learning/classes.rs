//! Theta over a cohort: of each class of surgery, and each case with the theta of the others of its class.

use std::collections::BTreeMap;

use super::cohort::Cohort;
use super::theta::{Theta, between};
use super::validation::{Column, lengths};

/// How the table calls Rubin and Bodner's tissue with the theta of the other cases.
const NAME: &str = "Rubin-Bodner";

/// Theta of one class of surgery, from all its cases.
#[derive(Clone, Debug, PartialEq)]
pub struct ThetaOfClass {
    pub class: String,
    pub patients: usize,
    pub theta: Theta,
}

/// How the skin of a case moves with theta 0.5, 1 and 1.5: displacements in mm, three numbers for each point.
pub type AtThetas = [Vec<f64>; 3];

/// Theta of each class, fitted to all its cases.
pub fn thetas(cohort: &Cohort, told: &[AtThetas]) -> Vec<ThetaOfClass> {
    let mut classes: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (place, case) in cohort.cases.iter().enumerate() {
        classes.entry(&case.class).or_default().push(place);
    }
    let of = |(class, own): (&str, Vec<usize>)| ThetaOfClass {
        class: class.to_owned(),
        patients: own.len(),
        theta: theta(cohort, told, &own),
    };
    classes.into_iter().map(of).collect()
}

/// The errors of each case with the theta of the others of its class, 1 where there are none.
pub fn held_out(cohort: &Cohort, told: &[AtThetas]) -> Column {
    let of = |case: usize| {
        let class = &cohort.cases[case].class;
        let others = cohort.others(case).into_iter();
        let others: Vec<usize> = others.filter(|&own| cohort.cases[own].class == *class).collect();
        let theta = if others.is_empty() { 1.0 } else { theta(cohort, told, &others).theta };
        with_theta(&told[case], theta)
    };
    let moved: Vec<Vec<f64>> = (0..cohort.len()).map(of).collect();
    Column::of(NAME, &moved, cohort)
}

/// The theta with the smallest mean error over some cases.
fn theta(cohort: &Cohort, told: &[AtThetas], among: &[usize]) -> Theta {
    Theta::fitted(|theta| {
        let error = |&own: &usize| {
            let lengths = lengths(&with_theta(&told[own], theta), &cohort.cases[own].actual);
            lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
        };
        among.iter().map(error).sum::<f64>() / among.len() as f64
    })
}

fn with_theta([low, middle, high]: &AtThetas, theta: f64) -> Vec<f64> {
    let all = low.iter().zip(middle).zip(high);
    all.map(|((&low, &middle), &high)| between(theta, [low, middle, high])).collect()
}
