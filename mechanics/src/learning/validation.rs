//! Leave-one-out and nested leave-one-out of learned predictions.
//!
//! Each case is predicted by what was fitted to the others. Plain: the width of a regression is that of all cases, the held-out
//! one among them, as in Zhang et al. 2016, which flatters. Nested: everything, width and standard, comes from the others alone.
//! Out of distribution: each case is predicted from those of other classes of surgery, of which nobody had what the case has.
//! Errors are E = 1/N sum_k |X_k - X'_k| over skin points (their equation 7), and the 95th percentile of the same lengths.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::bands::band;
use super::cohort::{Cohort, LEAST_TRAINING, Pool};
use super::deformation_model::ModeCount;
use super::features::Distance;
use super::learner::{ComparedCases, Fitted, Learner, Method, Rule, without};
use super::pairs::blended;
use crate::validation::Statistics;

/// Errors of the prediction of one case in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseErrors {
    pub mean: f64,
    pub p95: f64,
    /// Means by region.
    pub regions: BTreeMap<String, f64>,
}

/// A way of predicting over all cases: a column of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub name: String,
    /// In the order of the cohort.
    pub cases: Vec<CaseErrors>,
    /// Of each point of the skin, the mean over the cases in mm.
    pub points: Vec<f64>,
}

/// A learned method, each case predicted from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Validated {
    pub method: Method,
    /// With what was tuned on all cases; absent where the rule has nothing to tune.
    pub plain: Option<Column>,
    pub nested: Column,
    /// Whether a case is farther from the others than 95 % of these are from each other, so that it would be refused.
    pub is_refused: Vec<bool>,
    /// From the nearest other case, as a share of the distance beyond which it is refused.
    pub novelty: Vec<f64>,
    /// The share of all numbers within their band from 10 to 90 %; absent where cases are too few for one.
    pub coverage: Option<f64>,
    /// The nested prediction of each case.
    pub displacement: Vec<Vec<f64>>,
    /// Of a deformation model of all cases.
    pub modes: Option<ModeCount>,
    /// Absent where a case has fewer than two of other classes to be predicted from.
    pub other_classes: Option<OtherClasses>,
}

/// Cases that are predicted from those of other classes of surgery.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherClasses {
    pub column: Column,
    /// Whether a prediction of the case would be refused.
    pub is_refused: Vec<bool>,
}

impl CaseErrors {
    /// Of a displacement against the measured one.
    pub fn of(told: &[f64], actual: &[f64], regions: &BTreeMap<String, Vec<u32>>) -> Self {
        let lengths = lengths(told, actual);
        let statistics = Statistics::plain(&lengths).ok();
        let over = |points: &[u32]| {
            let sum: f64 = points.iter().map(|&point| lengths[point as usize]).sum();
            sum / points.len().max(1) as f64
        };
        CaseErrors {
            mean: statistics.map_or(0.0, |own| own.mean),
            p95: statistics.map_or(0.0, |own| own.p95),
            regions: regions.iter().map(|(name, points)| (name.clone(), over(points))).collect(),
        }
    }
}

/// |X_k - X'_k| of each point.
pub fn lengths(told: &[f64], actual: &[f64]) -> Vec<f64> {
    let points = told.chunks_exact(3).zip(actual.chunks_exact(3));
    points.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()).collect()
}

impl Column {
    /// Of one displacement for each case.
    pub fn of(name: &str, told: &[Vec<f64>], cohort: &Cohort) -> Self {
        let cases = told.iter().zip(&cohort.cases);
        let errors = |(told, case): (&Vec<f64>, &super::cohort::LearningCase)| {
            CaseErrors::of(told, &case.actual, &cohort.regions)
        };
        let points = told.first().map_or(0, |told| told.len() / 3);
        let mut sums = vec![0.0; points];
        for (told, case) in cases.clone() {
            let errors = lengths(told, &case.actual);
            sums.iter_mut().zip(&errors).for_each(|(sum, error)| *sum += error);
        }
        Column {
            name: name.to_owned(),
            cases: cases.map(errors).collect(),
            points: sums.iter().map(|sum| sum / told.len() as f64).collect(),
        }
    }

    /// The mean error of each case.
    pub fn means(&self) -> Vec<f64> {
        self.cases.iter().map(|case| case.mean).collect()
    }

    /// Over the cases.
    pub fn mean(&self) -> f64 {
        self.over(|case| case.mean)
    }

    pub fn p95(&self) -> f64 {
        self.over(|case| case.p95)
    }

    /// Absent where there is no such region.
    pub fn region(&self, name: &str) -> Option<f64> {
        let known = self.cases.iter().all(|case| case.regions.contains_key(name));
        known.then(|| self.over(|case| case.regions[name]))
    }

    fn over(&self, of: impl Fn(&CaseErrors) -> f64) -> f64 {
        self.cases.iter().map(of).sum::<f64>() / self.cases.len().max(1) as f64
    }
}

/// One fold.
struct Fold {
    plain: Vec<f64>,
    nested: Vec<f64>,
    novelty: f64,
    coverage: Option<f64>,
}

/// Predicts each case from the others.
pub fn validate(cohort: &Cohort, method: Method, distance: Distance) -> Validated {
    let compared = ComparedCases::new(cohort, method.target, distance);
    let all: Vec<usize> = (0..cohort.len()).collect();
    let tuned = compared.fit(method.learner, &all).rule;
    let folds: Vec<Fold> =
        all.par_iter().map(|&case| fold(&compared, method, &tuned, case)).collect();
    let name = method.name(&cohort.mechanical);
    let column = |suffix: &str, of: fn(&Fold) -> &Vec<f64>| {
        let told: Vec<Vec<f64>> = folds.iter().map(|fold| of(fold).clone()).collect();
        Column::of(&format!("{name}{suffix}"), &told, cohort)
    };
    let is_tuned = match method.learner {
        Learner::Regression | Learner::DeformationModel => true,
        Learner::DeformationModelByVariance => false,
    };
    let covered: Option<Vec<f64>> = folds.iter().map(|fold| fold.coverage).collect();
    Validated {
        method,
        plain: is_tuned.then(|| column(" (tuned on all)", |fold| &fold.plain)),
        nested: column("", |fold| &fold.nested),
        is_refused: folds.iter().map(|fold| fold.novelty > 1.0).collect(),
        novelty: folds.iter().map(|fold| fold.novelty).collect(),
        coverage: covered.map(|own| own.iter().sum::<f64>() / own.len() as f64),
        displacement: folds.into_iter().map(|fold| fold.nested).collect(),
        modes: tuned.modes(),
        other_classes: other_classes(&compared, method, &name),
    }
}

fn fold(compared: &ComparedCases, method: Method, tuned: &Rule, case: usize) -> Fold {
    let others = compared.cohort.others(case);
    let fitted = compared.fit(method.learner, &others);
    let flattered = compared.fit_as_tuned(tuned, method.learner, &others);
    let actual = &compared.cohort.cases[case].actual;
    Fold {
        plain: compared.displacement(&flattered, case, &others),
        nested: compared.displacement(&fitted, case, &others),
        novelty: novelty(compared, &fitted, case, &others),
        coverage: band_of(compared, method, &fitted, case, &others)
            .map(|band| covered(actual, &band)),
    }
}

/// How far a case is from the nearest training case, as a share of the distance beyond which it is refused.
fn novelty(compared: &ComparedCases, fitted: &Fitted, case: usize, training: &[usize]) -> f64 {
    compared.nearest(case, training) / fitted.farthest.max(f64::MIN_POSITIVE)
}

fn other_classes(compared: &ComparedCases, method: Method, name: &str) -> Option<OtherClasses> {
    let cohort = compared.cohort;
    if cohort.smallest_pool(Pool::OtherClasses) < LEAST_TRAINING {
        return None;
    }
    let of = |case: usize| {
        let training = cohort.pool(Pool::OtherClasses, case);
        let fitted = compared.fit(method.learner, &training);
        let is_refused = novelty(compared, &fitted, case, &training) > 1.0;
        (compared.displacement(&fitted, case, &training), is_refused)
    };
    let (told, is_refused): (Vec<Vec<f64>>, Vec<bool>) =
        (0..cohort.len()).into_par_iter().map(of).unzip();
    let column = Column::of(&format!("{name} (of other classes)"), &told, cohort);
    Some(OtherClasses { column, is_refused })
}

fn band_of(
    compared: &ComparedCases,
    method: Method,
    fitted: &Fitted,
    case: usize,
    others: &[usize],
) -> Option<Vec<[f64; 2]>> {
    let left_out = compared.left_out(fitted, method.learner, others);
    let told: Vec<Vec<f64>> = left_out
        .iter()
        .map(|left| compared.displacement(&left.fitted, case, &without(others, left.place)))
        .collect();
    band(left_out.len(), compared.cohort.cases[case].actual.len(), |place, range| {
        let missed = &left_out[place].missed[range.clone()];
        blended(&[1.0, 1.0], &[&told[place][range], missed])
    })
}

/// The share of numbers that lie within their band.
fn covered(actual: &[f64], band: &[[f64; 2]]) -> f64 {
    let held =
        actual.iter().zip(band).filter(|(actual, [low, high])| (low..=high).contains(actual));
    held.count() as f64 / actual.len().max(1) as f64
}
