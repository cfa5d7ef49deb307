//! Learning curve: the nested error of a method by the number of cases that it learned from.

use rayon::prelude::*;

use super::cohort::{Cohort, LEAST_TRAINING, Pool};
use super::features::Distance;
use super::learner::{ComparedCases, Method};
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

/// Each case is predicted from so many of those that it may be predicted from, drawn by the seed, and last from as many as each
/// case has. Empty where a case has fewer than two.
pub fn learning_curve(
    cohort: &Cohort,
    method: Method,
    distance: Distance,
    pool: Pool,
    seed: u64,
) -> Vec<CurvePoint> {
    let compared = ComparedCases::new(cohort, method.target, distance);
    let most = cohort.smallest_pool(pool);
    let sizes = SIZES.into_iter().filter(|&size| size < most).chain([most]);
    let sizes = sizes.filter(|&size| size >= LEAST_TRAINING);
    let point = |cases: usize| {
        let errors: Vec<f64> = (0..cohort.len())
            .into_par_iter()
            .map(|case| {
                error(&compared, method, case, &drawn(cohort.pool(pool, case), cases, seed, case))
            })
            .collect();
        CurvePoint { cases, error: errors.iter().sum::<f64>() / errors.len() as f64 }
    };
    sizes.map(point).collect()
}

fn error(compared: &ComparedCases, method: Method, case: usize, training: &[usize]) -> f64 {
    let fitted = compared.fit(method.learner, training);
    let told = compared.displacement(&fitted, case, training);
    let Cohort { cases, regions, .. } = compared.cohort;
    CaseErrors::of(&told, &cases[case].actual, regions).mean
}

/// So many of these cases, ascending.
fn drawn(mut among: Vec<usize>, count: usize, seed: u64, case: usize) -> Vec<usize> {
    let mut draws = Draws::of(seed, case as u64);
    while among.len() > count {
        among.swap_remove(draws.below(among.len()));
    }
    among.sort_unstable();
    among
}
