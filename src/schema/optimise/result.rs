//! The result of inverse planning: the plan, growth and constants, the residual of each target, and the uncertainty.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::document::OptimiseDocument;
use crate::schema::Triple;
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::plan::document::{GrowthDocument, PlanDocument, PlanSegmentDocument};
use crate::schema::wire::vector::Interval;
use mechanics::optimisation::{
    Bound, ConstantKind, Optimum, PARAMETERS_PER_SEGMENT, Parameter, Residual, Weight,
};
use mechanics::response::{InnerLoad, Response, ResponseSegment};

/// The plan nearest to the targets, and its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptimisationDocument {
    /// As `predict` takes it, with the estimated growth.
    pub plan: PlanDocument,
    /// As `predict` takes them beside the plan: those of the spec with the estimated constants; absent if none were
    /// estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// The residual of each target, in their order.
    pub targets: Vec<TargetResidualDocument>,
    /// The free parameters, those not at a bound, that the targets determine; tissue parameters are also included at a
    /// bound, with the standard error that they would have without it.
    pub parameters: Vec<FreeParameterDocument>,
    /// Of each of them, in its unit, for independent target errors of `sigma_mm`.
    pub standard_error: Vec<f64>,
    /// Of each pair of them, in their units.
    pub covariance: Vec<Vec<f64>>,
    /// The same over both standard errors: 1 or -1 if the targets determine only a difference or a sum of two.
    pub correlation: Vec<Vec<f64>>,
    /// Parameters at a bound.
    pub at_bound: Vec<AtBoundDocument>,
    /// Combinations of free parameters without first-order effect on the targets: the plan is not unique.
    /// Their parameters are as near to no change as the bounds allow.
    pub undetermined: Vec<Vec<PartDocument>>,
    /// The sum of the squares of residual over `sigma_mm`.
    pub chi_squared: f64,
    /// Target components minus determined combinations of parameters: the mean of `chi_squared`
    /// if the errors are those of `sigma_mm`.
    pub degrees_of_freedom: u64,
    /// Root of `chi_squared` over `degrees_of_freedom`: standard errors times this are those from the residual, independent of
    /// `sigma_mm`. Absent without degrees of freedom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub residual_factor: Option<f64>,
    pub iterations: u64,
    /// Starts of the search: 1, or 13 where an angle may be more than 20 degrees from rest.
    #[serde(default = "one_start")]
    #[schema(required)]
    pub starts: u64,
    /// `chi_squared` of the other minima that starts ended in, ascending: higher ones, and if the targets determine all parameters others
    /// as low with another movement.
    #[serde(default)]
    #[schema(required)]
    pub other_chi_squared: Vec<f64>,
    /// Of order 2: means over the skin that moves of the second-order term, and of the third-order term that is left out, estimated
    /// from samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub second_order_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub nonlinearity_estimate_mm: Option<f64>,
    /// The largest distance between the skin of the full solution, in order 2 at finite strain, and that of the response; absent
    /// without `verify`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub verified_difference_mm: Option<f64>,
}

/// Of a result that does not state it.
fn one_start() -> u64 {
    1
}

/// The residual of a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TargetResidualDocument {
    /// Root mean square over its points of the distance, in the components that are not free.
    pub residual_mm: f64,
    /// The largest of these distances.
    pub largest_mm: f64,
    /// Nodes of the skin, or 1 for a landmark.
    pub points: u64,
}

/// One of the six numbers of a segment, or growth or a constant of a region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FreeParameterDocument {
    /// Of a movement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
    /// Of growth or a constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    pub name: ParameterName,
    /// In mm, degrees, kPa or shares.
    pub value: f64,
}

/// A parameter at a bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AtBoundDocument {
    /// Of a movement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
    /// Of growth or a constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    pub name: ParameterName,
    pub value: f64,
    pub bound: BoundName,
}

/// The coefficient of a parameter in a combination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PartDocument {
    /// Of a movement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
    /// Of growth or a constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    pub name: ParameterName,
    /// In mm, degrees, hundredths of a volume or of Poisson's ratio, and per cent of Young's modulus; the largest of a
    /// combination is 1.
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
    #[serde(rename = "volume_change")]
    VolumeChange,
    #[serde(rename = "poisson_ratio")]
    PoissonRatio,
    #[serde(rename = "young_modulus_kpa")]
    YoungModulus,
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

/// An estimated constant: its region and its kind.
pub type NamedConstant = (String, ConstantKind);

/// The optimum, and its names.
#[derive(Clone, Copy)]
pub struct NamedOptimum<'a> {
    pub spec: &'a OptimiseDocument,
    pub response: &'a Response,
    pub constants: &'a [NamedConstant],
    pub optimum: &'a Optimum,
}

impl OptimisationDocument {
    /// An optimum with the names and the units of the documents.
    pub fn new(named: &NamedOptimum, materials: Option<MaterialDocuments>) -> Self {
        let optimum = named.optimum;
        let certainty = &optimum.certainty;
        let determined = &certainty.determined;
        let to_document = |(row, column): (usize, usize)| {
            let unit = named.unit(determined[row]) * named.unit(determined[column]);
            certainty.covariance[(row, column)] * unit
        };
        let count = determined.len();
        let correlation = certainty.correlation();
        let rows = |of: &dyn Fn((usize, usize)) -> f64| -> Vec<Vec<f64>> {
            (0..count).map(|row| (0..count).map(|column| of((row, column))).collect()).collect()
        };
        let errors = certainty.standard_errors().into_iter().zip(determined);
        let degrees_of_freedom = optimum.components.saturating_sub(certainty.rank);
        let spread = optimum.weighted_square_sum / degrees_of_freedom as f64;
        OptimisationDocument {
            plan: named.plan(),
            materials,
            targets: optimum.targets.iter().map(TargetResidualDocument::from).collect(),
            parameters: determined.iter().map(|&parameter| named.parameter(parameter)).collect(),
            standard_error: errors
                .map(|(error, &parameter)| error * named.unit(parameter))
                .collect(),
            covariance: rows(&to_document),
            correlation: rows(&|at| correlation[at]),
            at_bound: optimum.at_bound.iter().map(|&stopped| named.at_bound(stopped)).collect(),
            undetermined: certainty.undetermined.iter().map(|parts| named.parts(parts)).collect(),
            chi_squared: optimum.weighted_square_sum,
            degrees_of_freedom: degrees_of_freedom as u64,
            residual_factor: (degrees_of_freedom > 0).then(|| spread.sqrt()),
            iterations: optimum.iterations as u64,
            starts: optimum.starts as u64,
            other_chi_squared: optimum.other_minima.clone(),
            second_order_mm: optimum.beyond.map(|beyond| beyond.second),
            nonlinearity_estimate_mm: optimum.beyond.map(|beyond| beyond.third),
            verified_difference_mm: None,
        }
    }
}

impl NamedOptimum<'_> {
    /// Value in the document's unit of one mm, one radian, a share of 1, or a factor e of a modulus.
    fn unit(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Movement { .. } if parameter.is_angle() => 1_f64.to_degrees(),
            Parameter::Movement { .. } | Parameter::Growth(_) => 1.0,
            Parameter::Constant(place) => match self.constants[place].1 {
                ConstantKind::YoungModulus => self.optimum.constants[place].exp(),
                ConstantKind::PoissonRatio => 1.0,
            },
        }
    }

    /// Converting to radians or to a logarithm and back must not lead out of the bounds by a rounding.
    fn value(&self, parameter: Parameter) -> f64 {
        let value = self.optimum.value(parameter);
        match parameter {
            Parameter::Movement { segment, number } => {
                let name = &self.response.segments[segment].name;
                let [low, high] = self.spec.bounds_of(name).intervals()[number];
                (value * self.unit(parameter)).clamp(low, high)
            }
            Parameter::Growth(_) => value,
            Parameter::Constant(place) => {
                let (region, kind) = &self.constants[place];
                let bounds = self.spec.tissue_bounds_of(region);
                let own = match kind {
                    ConstantKind::YoungModulus => bounds.young_modulus_kpa,
                    ConstantKind::PoissonRatio => bounds.poisson_ratio,
                };
                let value = kind.constant(value);
                own.map_or(value, |Interval([low, high])| value.clamp(low, high))
            }
        }
    }

    fn plan(&self) -> PlanDocument {
        let segment = |(segment, own): (usize, &ResponseSegment)| {
            let values: [f64; PARAMETERS_PER_SEGMENT] =
                std::array::from_fn(|number| self.value(Parameter::Movement { segment, number }));
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
        let segments = self.response.segments.iter().enumerate().map(segment).collect();
        let mut plan = PlanDocument { segments, ..self.spec.held() };
        let loads = self.response.inner.iter().zip(&self.optimum.growth);
        for (load, &volume_change) in loads.skip(plan.growth.len()) {
            if let InnerLoad::Growth(region) = load {
                plan.growth.push(GrowthDocument { region: region.clone(), volume_change });
            }
        }
        plan
    }

    /// The segment or the region of a parameter, and its name.
    fn name(&self, parameter: Parameter) -> (Option<String>, Option<String>, ParameterName) {
        match parameter {
            Parameter::Movement { segment, number } => {
                (Some(self.response.segments[segment].name.clone()), None, NAMES[number])
            }
            Parameter::Growth(place) => {
                let (InnerLoad::Growth(name) | InnerLoad::Muscle(name)) =
                    &self.response.inner[place];
                (None, Some(name.clone()), ParameterName::VolumeChange)
            }
            Parameter::Constant(place) => {
                let (region, kind) = &self.constants[place];
                let name = match kind {
                    ConstantKind::YoungModulus => ParameterName::YoungModulus,
                    ConstantKind::PoissonRatio => ParameterName::PoissonRatio,
                };
                (None, Some(region.clone()), name)
            }
        }
    }

    fn parameter(&self, parameter: Parameter) -> FreeParameterDocument {
        let (segment, region, name) = self.name(parameter);
        FreeParameterDocument { segment, region, name, value: self.value(parameter) }
    }

    fn at_bound(&self, (parameter, bound): (Parameter, Bound)) -> AtBoundDocument {
        let (segment, region, name) = self.name(parameter);
        let bound = match bound {
            Bound::Lower => BoundName::Lower,
            Bound::Upper => BoundName::Upper,
        };
        AtBoundDocument { segment, region, name, value: self.value(parameter), bound }
    }

    fn parts(&self, parts: &[Weight]) -> Vec<PartDocument> {
        let part = |weight: &Weight| {
            let (segment, region, name) = self.name(weight.parameter);
            PartDocument { segment, region, name, part: weight.part }
        };
        parts.iter().map(part).collect()
    }
}

impl ParameterName {
    /// Its name in sentences.
    pub fn words(self) -> &'static str {
        match self {
            ParameterName::TranslationX
            | ParameterName::TranslationY
            | ParameterName::TranslationZ => "the translation",
            ParameterName::RotationX | ParameterName::RotationY | ParameterName::RotationZ => {
                "the rotation"
            }
            ParameterName::VolumeChange => "the change of volume",
            ParameterName::PoissonRatio => "Poisson's ratio",
            ParameterName::YoungModulus => "Young's modulus",
        }
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
