//! The answer of learning: the table of all methods over all cases, tests, the learning curve, and what is refused.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::cohort::result::CohortPairDocument;
use crate::schema::cohort::stored::CohortVersionDocument;
pub use crate::schema::learn::made::{MadeCohortDocument, RedrawnDocument};
use mechanics::learning::LearningCase;
use mechanics::learning::classes::ThetaOfClass;
use mechanics::learning::curve::CurvePoint;
use mechanics::learning::deformation_model::ModeCount;
use mechanics::learning::hill_climb::{Climb, ClimbEnd};
use mechanics::learning::regression::{Width, WidthEnd};
use mechanics::learning::validation::{CaseErrors, Column, OtherClasses, Validated};

/// What was learned, and how good it is. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LearningDocument {
    /// The stored cohort that was learned from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<CohortVersionDocument>,
    /// The method whose model is kept.
    pub method: String,
    /// The method of the mechanical predictions, by which `table` calls them.
    #[serde(default = "usual_mechanical")]
    #[schema(required)]
    pub mechanical: String,
    /// How its width was found, of a regression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub width: Option<WidthDocument>,
    /// Whether its nested error is below that of the mechanical prediction.
    pub helps: bool,
    /// The cases, in the order of `cases` of the table.
    #[serde(default)]
    #[schema(required)]
    pub patients: Vec<LearnedPatientDocument>,
    /// One for each method; what is learned is nested unless its name says that it was tuned on all cases.
    pub table: Vec<LearnedColumnDocument>,
    /// Wilcoxon's signed rank test of each learned method, nested, against the mechanical prediction.
    pub tests: Vec<CohortPairDocument>,
    pub validation: Vec<ValidationDocument>,
    pub curve: Vec<CurveDocument>,
    /// The same where each case is predicted from those of other classes alone, as many as every case has; absent with fewer than two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_of_other_classes: Vec<CurveDocument>,
    /// Of virtual patients.
    #[serde(default, rename = "virtual", skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub made: Option<MadeCohortDocument>,
    /// Of Rubin and Bodner's tissue: of virtual patients, and where `theta` was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thetas: Vec<ThetaDocument>,
}

/// How the table of earlier versions called every mechanical prediction.
fn usual_mechanical() -> String {
    "linear".to_owned()
}

/// An operated case, or a virtual patient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LearnedPatientDocument {
    pub name: String,
    /// Of surgery.
    pub class: String,
    /// How far the node of bone goes that goes farthest.
    pub largest_bone_movement_mm: f64,
}

/// The width of a regression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WidthDocument {
    pub end: WidthEndName,
    /// Absent at the ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub width: Option<f64>,
    /// Of the cases predicted from each other with it: the root of the mean square of the length of a whole skin's error.
    #[serde(default)]
    #[schema(required)]
    pub rmse: f64,
    /// Where the search of Zhang et al. 2016 comes to: from 1 in steps of 0.01.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub climb: Option<ClimbDocument>,
}

/// The climb to a width in steps of one length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ClimbDocument {
    pub width: f64,
    pub rmse: f64,
    /// By which the error fell.
    pub steps: u64,
    pub end: ClimbEndName,
}

/// How a climb ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClimbEndName {
    /// Both neighbours are worse: it goes back and forth for good.
    Alternates,
    /// The error does not change: it does not know where to go.
    Flat,
    /// The next width would not be positive.
    AtZero,
    /// It was still going.
    OutOfSteps,
}

impl WidthDocument {
    pub fn new(found: Width, climb: Climb) -> Self {
        WidthDocument {
            end: found.end.into(),
            width: (found.width.is_finite() && found.width > 0.0).then_some(found.width),
            rmse: found.rmse,
            climb: Some(climb.into()),
        }
    }
}

impl From<ClimbEnd> for ClimbEndName {
    fn from(end: ClimbEnd) -> Self {
        match end {
            ClimbEnd::Alternates => ClimbEndName::Alternates,
            ClimbEnd::Flat => ClimbEndName::Flat,
            ClimbEnd::AtZero => ClimbEndName::AtZero,
            ClimbEnd::OutOfSteps => ClimbEndName::OutOfSteps,
        }
    }
}

impl From<Climb> for ClimbDocument {
    fn from(own: Climb) -> Self {
        let (width, rmse, end) = (own.width, own.rmse, own.end.into());
        ClimbDocument { width, rmse, steps: own.steps as u64, end }
    }
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
    #[serde(flatten)]
    pub gains: GainsDocument,
    /// Of a deformation model of all cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub modes: Option<ModesDocument>,
    /// Where each case is predicted from those of other classes of surgery. Absent where one has fewer than two of these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub other_classes: Option<OtherClassesDocument>,
}

/// Whom a method betters and whom it harms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GainsDocument {
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

/// The modes of a deformation model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ModesDocument {
    pub count: u64,
    /// That so many cases permit: two fewer than cases, three where their number is chosen by leaving cases out.
    pub most: u64,
    /// Whether the rule wanted `most` or more: there are too few cases for it.
    pub is_limited_by_cases: bool,
}

/// What validation says of cases that are predicted from those of other classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OtherClassesDocument {
    pub mean: f64,
    pub p95: f64,
    #[serde(flatten)]
    pub gains: GainsDocument,
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

impl GainsDocument {
    /// Of a method, against what mechanics says of the same cases.
    fn new(column: &Column, is_refused: &[bool], mechanical: &[f64], names: &[String]) -> Self {
        let own = column.means();
        let gains: Vec<f64> = mechanical.iter().zip(&own).map(|(one, other)| one - other).collect();
        let those = |holds: &dyn Fn(usize) -> bool| -> Vec<usize> {
            (0..names.len()).filter(|&case| holds(case)).collect()
        };
        let named = |cases: &[usize]| cases.iter().map(|&case| names[case].clone()).collect();
        let gain = |cases: &[usize]| {
            let sum: f64 = cases.iter().map(|&case| gains[case]).sum();
            (!cases.is_empty()).then(|| sum / cases.len() as f64)
        };
        let refused = those(&|case| is_refused[case]);
        GainsDocument {
            harmed: named(&those(&|case| gains[case] < 0.0)),
            gain_of_refused_mm: gain(&refused),
            gain_of_others_mm: gain(&those(&|case| !is_refused[case])),
            refused: named(&refused),
        }
    }
}

impl ValidationDocument {
    /// Of a method, against what mechanics says of the same cases.
    pub fn new(validated: &Validated, mechanical: &[f64], names: &[String]) -> Self {
        let gains = |column: &Column, is_refused: &[bool]| {
            GainsDocument::new(column, is_refused, mechanical, names)
        };
        let other = |own: &OtherClasses| OtherClassesDocument {
            mean: own.column.mean(),
            p95: own.column.p95(),
            gains: gains(&own.column, &own.is_refused),
        };
        ValidationDocument {
            method: validated.nested.name.clone(),
            coverage: validated.coverage,
            gains: gains(&validated.nested, &validated.is_refused),
            modes: validated.modes.map(Into::into),
            other_classes: validated.other_classes.as_ref().map(other),
        }
    }
}

impl From<ModeCount> for ModesDocument {
    fn from(own: ModeCount) -> Self {
        let [count, most] = [own.count, own.most].map(|own| own as u64);
        ModesDocument { count, most, is_limited_by_cases: own.is_limited }
    }
}

impl From<&LearningCase> for LearnedPatientDocument {
    fn from(own: &LearningCase) -> Self {
        LearnedPatientDocument {
            name: own.name.clone(),
            class: own.class.clone(),
            largest_bone_movement_mm: own.largest_bone_movement(),
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
