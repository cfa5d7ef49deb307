//! The answer of learning: the table of all methods over all cases, tests, the learning curve, and what is refused.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::cohort::result::CohortPairDocument;
use crate::schema::cohort::stored::CohortVersionDocument;
use mechanics::learning::classes::ThetaOfClass;
use mechanics::learning::curve::CurvePoint;
use mechanics::learning::regression::WidthEnd;
use mechanics::learning::validation::{CaseErrors, Column, Validated};

/// What was learned, and how good it is. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LearningDocument {
    /// The stored cohort that was learned from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<CohortVersionDocument>,
    /// The method whose model is kept.
    pub method: String,
    /// How its width was found, of a regression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub width: Option<WidthDocument>,
    /// Whether its nested error is below that of the mechanical prediction.
    pub helps: bool,
    /// One for each method; what is learned is nested unless its name says that it was tuned on all cases.
    pub table: Vec<LearnedColumnDocument>,
    /// Wilcoxon's signed rank test of each learned method, nested, against the mechanical prediction.
    pub tests: Vec<CohortPairDocument>,
    pub validation: Vec<ValidationDocument>,
    pub curve: Vec<CurveDocument>,
    /// Of Rubin and Bodner's tissue: of virtual patients, and where `theta` was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thetas: Vec<ThetaDocument>,
}

/// The width of a regression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WidthDocument {
    pub end: WidthEndName,
    /// Absent at the ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub width: Option<f64>,
}

/// Where the search of a width came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WidthEndName {
    Inside,
    /// The smaller the better: the answer is that of the nearest case.
    NearestNeighbour,
    /// The larger the better: features say nothing.
    Mean,
}

impl From<WidthEnd> for WidthEndName {
    fn from(end: WidthEnd) -> Self {
        match end {
            WidthEnd::Inside => WidthEndName::Inside,
            WidthEnd::NearestNeighbour => WidthEndName::NearestNeighbour,
            WidthEnd::Mean => WidthEndName::Mean,
        }
    }
}

/// One method over all cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LearnedColumnDocument {
    pub name: String,
    /// Over the cases.
    pub mean: f64,
    pub p95: f64,
    /// Means by region.
    pub regions: BTreeMap<String, f64>,
    pub cases: Vec<CaseErrorsDocument>,
}

/// Of one case: the mean and the 95th percentile over points of the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CaseErrorsDocument {
    pub name: String,
    pub mean: f64,
    pub p95: f64,
}

/// What validation says of a method beside its errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ValidationDocument {
    pub method: String,
    /// Of numbers within their band from 10 to 90 %: 0.8 is right. Absent with fewer than 10 cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub coverage: Option<f64>,
    /// Cases that are farther from the others than 95 % of these among each other: a prediction of them is refused.
    pub refused: Vec<String>,
    /// Cases that it brings farther from the truth than mechanics does.
    pub harmed: Vec<String>,
    /// By what it betters the mean error of cases that are refused, and of those that are not; negative where it harms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub gain_of_refused_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub gain_of_others_mm: Option<f64>,
}

/// The nested error of a method by the number of cases that it learned from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveDocument {
    pub method: String,
    pub points: Vec<CurvePointDocument>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurvePointDocument {
    pub cases: u64,
    pub error_mm: f64,
}

/// Theta of a class of surgery.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ThetaDocument {
    pub class: String,
    pub patients: u64,
    pub theta: f64,
    pub error_mm: f64,
    /// By how much the error changes from theta 0.5 to 1.5.
    pub spread_mm: f64,
    /// Whether the data determine it: the spread is 0.01 mm or more, and theta not at an end.
    pub is_determined: bool,
}

impl LearnedColumnDocument {
    pub fn new(column: &Column, names: &[String]) -> Self {
        let regions = column.cases.first().map(|case| case.regions.keys()).into_iter().flatten();
        let of = |(name, case): (&String, &CaseErrors)| CaseErrorsDocument {
            name: name.clone(),
            mean: case.mean,
            p95: case.p95,
        };
        LearnedColumnDocument {
            name: column.name.clone(),
            mean: column.mean(),
            p95: column.p95(),
            regions: regions
                .filter_map(|name| Some((name.clone(), column.region(name)?)))
                .collect(),
            cases: names.iter().zip(&column.cases).map(of).collect(),
        }
    }
}

impl ValidationDocument {
    /// Of a method, against what mechanics says of the same cases.
    pub fn new(validated: &Validated, mechanical: &[f64], names: &[String]) -> Self {
        let nested = validated.nested.means();
        let gains: Vec<f64> =
            mechanical.iter().zip(&nested).map(|(one, other)| one - other).collect();
        let those = |holds: &dyn Fn(usize) -> bool| -> Vec<usize> {
            (0..names.len()).filter(|&case| holds(case)).collect()
        };
        let named = |cases: &[usize]| cases.iter().map(|&case| names[case].clone()).collect();
        let gain = |cases: &[usize]| {
            let sum: f64 = cases.iter().map(|&case| gains[case]).sum();
            (!cases.is_empty()).then(|| sum / cases.len() as f64)
        };
        let refused = those(&|case| validated.is_refused[case]);
        let others = those(&|case| !validated.is_refused[case]);
        ValidationDocument {
            method: validated.method.name().to_owned(),
            coverage: validated.coverage,
            harmed: named(&those(&|case| gains[case] < 0.0)),
            gain_of_refused_mm: gain(&refused),
            gain_of_others_mm: gain(&others),
            refused: named(&refused),
        }
    }
}

impl From<&CurvePoint> for CurvePointDocument {
    fn from(point: &CurvePoint) -> Self {
        CurvePointDocument { cases: point.cases as u64, error_mm: point.error }
    }
}

impl From<&ThetaOfClass> for ThetaDocument {
    fn from(own: &ThetaOfClass) -> Self {
        ThetaDocument {
            class: own.class.clone(),
            patients: own.patients as u64,
            theta: own.theta.theta,
            error_mm: own.theta.error,
            spread_mm: own.theta.spread,
            is_determined: own.theta.is_determined(),
        }
    }
}
