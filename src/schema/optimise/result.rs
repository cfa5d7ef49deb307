//! The answer of inverse planning: the plan, what is left of each target, and how certain the plan is.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::document::OptimiseDocument;
use crate::schema::Triple;
use crate::schema::plan::document::{PlanDocument, PlanSegmentDocument};
use mechanics::optimisation::{
    Bound, Optimum, PARAMETERS_PER_SEGMENT, Parameter, Residual, Weight,
};
use mechanics::response::ResponseSegment;

/// The plan that comes nearest to the targets, and how certain it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptimisationDocument {
    /// As `predict` takes it.
    pub plan: PlanDocument,
    /// What is left of each target, in their order.
    pub targets: Vec<TargetResidualDocument>,
    /// The parameters that are free, that is, not at a bound, and that the targets determine.
    pub parameters: Vec<FreeParameterDocument>,
    /// Of each of them, in mm or degrees, if the targets have independent errors of `sigma_mm`.
    pub standard_error: Vec<f64>,
    /// Of each two of them, in mm and degrees.
    pub covariance: Vec<Vec<f64>>,
    /// Parameters that a bound stops.
    pub at_bound: Vec<AtBoundDocument>,
    /// Combinations of free parameters that no target feels, to first order: the plan is one of many.
    /// Their parameters stay as near to rest as the bounds allow.
    pub undetermined: Vec<Vec<PartDocument>>,
    /// The sum of the squares of residual over `sigma_mm`.
    pub chi_squared: f64,
    /// Components of targets less determined combinations of parameters: the mean of `chi_squared`
    /// where the errors are those of `sigma_mm`.
    pub degrees_of_freedom: u64,
    pub iterations: u64,
    /// The largest distance between the skin of the full solution and that of the response; absent
    /// without `verify`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub verified_difference_mm: Option<f64>,
}

/// What is left of a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TargetResidualDocument {
    /// Root of the mean over its points of the squared distance, over the components that are not free.
    pub residual_mm: f64,
    /// The largest of these distances.
    pub largest_mm: f64,
    /// Nodes of the skin, or 1 for a landmark.
    pub points: u64,
}

/// One of the six numbers of a segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FreeParameterDocument {
    pub segment: String,
    pub name: ParameterName,
    /// In mm or degrees.
    pub value: f64,
}

/// A number that a bound stops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AtBoundDocument {
    pub segment: String,
    pub name: ParameterName,
    pub value: f64,
    pub bound: BoundName,
}

/// The part of a parameter in a combination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PartDocument {
    pub segment: String,
    pub name: ParameterName,
    /// In mm or degrees; the largest part of a combination is 1.
    pub part: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum ParameterName {
    #[serde(rename = "translation_mm.x")]
    TranslationX,
    #[serde(rename = "translation_mm.y")]
    TranslationY,
    #[serde(rename = "translation_mm.z")]
    TranslationZ,
    #[serde(rename = "rotation_deg.x")]
    RotationX,
    #[serde(rename = "rotation_deg.y")]
    RotationY,
    #[serde(rename = "rotation_deg.z")]
    RotationZ,
}

const NAMES: [ParameterName; PARAMETERS_PER_SEGMENT] = [
    ParameterName::TranslationX,
    ParameterName::TranslationY,
    ParameterName::TranslationZ,
    ParameterName::RotationX,
    ParameterName::RotationY,
    ParameterName::RotationZ,
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum BoundName {
    Lower,
    Upper,
}

/// An optimum with the names and the units of the documents.
struct Named<'a> {
    spec: &'a OptimiseDocument,
    segments: &'a [ResponseSegment],
    optimum: &'a Optimum,
}

impl OptimisationDocument {
    /// An optimum over a response with these segments.
    pub fn new(spec: &OptimiseDocument, segments: &[ResponseSegment], optimum: &Optimum) -> Self {
        let named = Named { spec, segments, optimum };
        let certainty = &optimum.certainty;
        let determined = &certainty.determined;
        let to_document = |(row, column): (usize, usize)| {
            certainty.covariance[(row, column)] * unit(determined[row]) * unit(determined[column])
        };
        let count = determined.len();
        let row = |row: usize| (0..count).map(|column| to_document((row, column))).collect();
        let errors = certainty.standard_errors().into_iter().zip(determined);
        OptimisationDocument {
            plan: named.plan(),
            targets: optimum.targets.iter().map(TargetResidualDocument::from).collect(),
            parameters: determined.iter().map(|&parameter| named.parameter(parameter)).collect(),
            standard_error: errors.map(|(error, &parameter)| error * unit(parameter)).collect(),
            covariance: (0..count).map(row).collect(),
            at_bound: optimum.at_bound.iter().map(|&stopped| named.at_bound(stopped)).collect(),
            undetermined: certainty.undetermined.iter().map(|parts| named.parts(parts)).collect(),
            chi_squared: optimum.weighted_square_sum,
            degrees_of_freedom: optimum.components.saturating_sub(certainty.rank) as u64,
            iterations: optimum.iterations as u64,
            verified_difference_mm: None,
        }
    }
}

/// How much of the document's unit, mm or degrees, one mm or radian is.
fn unit(parameter: Parameter) -> f64 {
    if parameter.is_angle() { 1_f64.to_degrees() } else { 1.0 }
}

impl Named<'_> {
    /// Converting to radians and back must not lead out of the bounds by a rounding.
    fn value(&self, parameter: Parameter) -> f64 {
        let name = &self.segments[parameter.segment].name;
        let [low, high] = self.spec.bounds_of(name).intervals()[parameter.number];
        let value = self.optimum.parameters[parameter.segment][parameter.number];
        (value * unit(parameter)).clamp(low, high)
    }

    fn plan(&self) -> PlanDocument {
        let segment = |(segment, own): (usize, &ResponseSegment)| {
            let values: [f64; PARAMETERS_PER_SEGMENT] =
                std::array::from_fn(|number| self.value(Parameter { segment, number }));
            let [x, y, z, a, b, c] = values;
            let turns = [a, b, c] != [0.0; 3];
            PlanSegmentDocument {
                name: own.name.clone(),
                translation_mm: Some(Triple([x, y, z])),
                rotation_deg: turns.then_some(Triple([a, b, c])),
                pivot_mm: self.spec.bounds_of(&own.name).pivot_mm.filter(|_| turns),
                ..PlanSegmentDocument::default()
            }
        };
        let segments = self.segments.iter().enumerate().map(segment).collect();
        PlanDocument { segments, ..self.spec.held() }
    }

    fn name(&self, parameter: Parameter) -> (String, ParameterName) {
        (self.segments[parameter.segment].name.clone(), NAMES[parameter.number])
    }

    fn parameter(&self, parameter: Parameter) -> FreeParameterDocument {
        let (segment, name) = self.name(parameter);
        FreeParameterDocument { segment, name, value: self.value(parameter) }
    }

    fn at_bound(&self, (parameter, bound): (Parameter, Bound)) -> AtBoundDocument {
        let (segment, name) = self.name(parameter);
        let bound = match bound {
            Bound::Lower => BoundName::Lower,
            Bound::Upper => BoundName::Upper,
        };
        AtBoundDocument { segment, name, value: self.value(parameter), bound }
    }

    fn parts(&self, parts: &[Weight]) -> Vec<PartDocument> {
        let part = |weight: &Weight| {
            let (segment, name) = self.name(weight.parameter);
            PartDocument { segment, name, part: weight.part }
        };
        parts.iter().map(part).collect()
    }
}

impl From<&Residual> for TargetResidualDocument {
    fn from(residual: &Residual) -> Self {
        TargetResidualDocument {
            residual_mm: residual.rms,
            largest_mm: residual.largest,
            points: residual.points as u64,
        }
    }
}
