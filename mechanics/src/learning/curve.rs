//! Learning curve: the nested error of a method by the number of cases that it learned from.

use rayon::prelude::*;

use super::cohort::Cohort;
use super::features::Distance;
use super::learner::{Compared, Method};
use super::validation::CaseErrors;
use crate::draws::Draws;

/// Numbers of training cases that are tried, as far as there are so many.
const SIZES: [usize; 8] = [3, 5, 8, 10, 15, 20, 30, 45];

/// The mean error over held-out cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Cases that were learned from.
    pub cases: usize,
    /// In mm.
    pub error: f64,
}

/// Each case is predicted from so many of the others, drawn by the seed, and last from all of them.
pub fn learning_curve(
    cohort: &Cohort,
    method: Method,
    distance: Distance,
    seed: u64,
) -> Vec<CurvePoint> {
    let compared = Compared::new(cohort, method.target, distance);
    let most = cohort.len() - 1;
    let sizes = SIZES.into_iter().filter(|&size| size < most).chain([most]);
    let point = |cases: usize| {
        let errors: Vec<f64> = (0..cohort.len())
            .into_par_iter()
            .map(|case| error(&compared, method, case, &drawn(cohort, case, cases, seed)))
            .collect();
        CurvePoint { cases, error: errors.iter().sum::<f64>() / errors.len() as f64 }
    };
    sizes.map(point).collect()
}

fn error(compared: &Compared, method: Method, case: usize, training: &[usize]) -> f64 {
    let fitted = compared.fit(method.learner, training);
    let told = compared.displacement(&fitted, case, training);
    let Cohort { cases, regions } = compared.cohort;
    CaseErrors::of(&told, &cases[case].actual, regions).mean
}

/// So many of the other cases, ascending.
fn drawn(cohort: &Cohort, case: usize, count: usize, seed: u64) -> Vec<usize> {
    let mut draws = Draws::of(seed, case as u64);
    let mut others = cohort.others(case);
    while others.len() > count {
        others.swap_remove(draws.below(others.len()));
    }
    others.sort_unstable();
    others
}
