//! `GET /v1/methods`: the ways of modelling, by the names a spec may give.

mod dvs;
mod fem_linear;
mod measured;
mod msm;
mod mtm;
mod mtm_ti;
mod thickness_warp;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
pub use measured::{MeasuredDocument, time_band};
use mechanics::optimisation::UNDETERMINED;
use mechanics::prediction::ElementChoice;
use mechanics::response::COLUMNS_PER_SEGMENT;
use mechanics::response::linearity::LINEAR_RANGE_MM;

/// Why `auto` is what it is.
pub const WHY_LINEAR: &str = "auto: fem_linear, until something chooses between models";
/// Why a method that was asked for by name is used.
pub const WHY_ASKED: &str = "asked for by the spec";

/// Of a method that was built after the study that comes with the program.
const NOT_MEASURED: &str = "the study that comes with the program has no row of this method";

/// A way of modelling soft tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MethodName {
    #[default]
    Auto,
    FemLinear,
    FemCorotational,
    FemNeoHookean,
    FemMooneyRivlin,
    FemOgden,
    FemRubinBodner,
    Mtm,
    MtmTi,
    Msm,
    Dvs,
    ThicknessWarp,
}

/// The treatment of cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementName {
    /// `stabilised`: no element locks.
    #[default]
    Auto,
    /// Full integration for every shape; locks above a Poisson ratio of 0.45, with a warning.
    Plain,
    /// Mean dilatation for hex8 and wedge6, the plain element for tet4.
    MeanDilatation,
    /// Mean dilatation for hex8 and wedge6, displacement and stabilised pressure for tet4.
    Stabilised,
    /// Tetrahedra with a node in the middle of each edge; refused for other shapes.
    Quadratic,
}

impl MethodName {
    /// Whether it is built.
    pub fn is_available(self) -> bool {
        use MethodName::{Auto, Dvs, FemLinear, Msm, Mtm, MtmTi, ThicknessWarp};
        matches!(self, Auto | FemLinear | Msm | Mtm | MtmTi | Dvs | ThicknessWarp)
    }

    /// The method that is used: what `auto` chooses, or the one asked for.
    pub fn chosen(self) -> MethodName {
        match self {
            MethodName::Auto => MethodName::FemLinear,
            named => named,
        }
    }

    /// As it stands in documents.
    pub fn name(self) -> &'static str {
        match self {
            MethodName::Auto => "auto",
            MethodName::FemLinear => "fem_linear",
            MethodName::FemCorotational => "fem_corotational",
            MethodName::FemNeoHookean => "fem_neo_hookean",
            MethodName::FemMooneyRivlin => "fem_mooney_rivlin",
            MethodName::FemOgden => "fem_ogden",
            MethodName::FemRubinBodner => "fem_rubin_bodner",
            MethodName::Mtm => "mtm",
            MethodName::MtmTi => "mtm_ti",
            MethodName::Msm => "msm",
            MethodName::Dvs => "dvs",
            MethodName::ThicknessWarp => "thickness_warp",
        }
    }

    pub fn why(self) -> &'static str {
        match self {
            MethodName::Auto => WHY_LINEAR,
            _ => WHY_ASKED,
        }
    }
}

/// Refuses a method that is not built, naming those that are.
pub fn check_method(method: MethodName, at: &Pointer, faults: &mut Faults) {
    if !method.is_available() {
        let names: Vec<String> = documents().map(|row| format!("`{}`", row.name.name())).collect();
        let detail = format!("this method is not available; `auto` and {} are", names.join(", "));
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
    }
}

/// Refuses, for plan responses, a method whose skin is not linear in the movements, or that has none of its own.
pub fn check_linear(method: MethodName, at: &Pointer, faults: &mut Faults) {
    let is_linear = matches!(method.chosen(), MethodName::FemLinear | MethodName::MtmTi);
    if method.is_available() && !is_linear {
        let detail = "responses are built by `fem_linear` and `mtm_ti`";
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
    }
}

/// Refuses settings of a method in the spec of another one.
pub fn check_own(
    own: MethodName,
    is_given: bool,
    method: MethodName,
    at: &Pointer,
    faults: &mut Faults,
) {
    if is_given && method.chosen() != own {
        let name = own.name();
        let detail =
            format!("these are settings of `{name}`, and the method is `{}`", method.name());
        faults.add(&at.key(name), ErrorCode::MethodMismatch, detail);
    }
}

impl ElementName {
    /// As it stands in documents.
    pub fn name(self) -> &'static str {
        match self {
            ElementName::Auto => "auto",
            ElementName::Plain => "plain",
            ElementName::MeanDilatation => "mean_dilatation",
            ElementName::Stabilised => "stabilised",
            ElementName::Quadratic => "quadratic",
        }
    }

    /// The element of the path.
    pub fn choice(self) -> ElementChoice {
        match self {
            ElementName::Auto => ElementChoice::Auto,
            ElementName::Plain => ElementChoice::Plain,
            ElementName::MeanDilatation => ElementChoice::MeanDilatation,
            ElementName::Stabilised => ElementChoice::Stabilised,
            ElementName::Quadratic => ElementChoice::Quadratic,
        }
    }
}

/// The answer of `GET /v1/methods`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodList {
    pub methods: Vec<MeasuredMethod>,
    /// What `auto` chooses, and why.
    pub auto: String,
    pub response: ResponseMethod,
    pub optimise: OptimiseMethod,
}

/// How jobs of kind `optimise` find a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptimiseMethod {
    /// Those whose skin is linear in the movements.
    pub methods: Vec<MethodName>,
    /// What is minimised, and how.
    pub minimises: String,
    /// How `standard_error` and `covariance` come about.
    pub certainty: String,
    /// A combination of parameters is undetermined where it moves the targets by less than this share of
    /// what the strongest one does.
    pub undetermined_below: f64,
}

/// What jobs of kind `response` build.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponseMethod {
    /// The linear ones.
    pub methods: Vec<MethodName>,
    pub columns_per_segment: u32,
    /// How `nonlinearity_estimate_mm` of an applied plan comes about.
    pub nonlinearity_estimate: String,
    /// The estimate above which an answer is outside the linear range.
    pub linear_range_mm: f64,
}

/// A way of modelling, and where it stands on the chart of speed and accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasuredMethod {
    #[serde(flatten)]
    pub method: MethodDocument,
    /// What the study that comes with the program measured; its truths, machine and command are in
    /// docs/speed-and-accuracy.md.
    pub measured: Vec<MeasuredDocument>,
    /// Why there is nothing in `measured`, where there is nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub not_measured: Option<String>,
}

impl MeasuredMethod {
    fn of(method: MethodDocument) -> Self {
        let measured = measured::measured(method.name.name());
        let not_measured = measured.is_empty().then(|| NOT_MEASURED.to_owned());
        MeasuredMethod { method, measured, not_measured }
    }
}

/// A way of modelling that a spec may ask for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodDocument {
    pub name: MethodName,
    pub title: String,
    /// What it takes for granted, and what it cannot represent.
    pub assumptions: Vec<String>,
    /// The elements it knows; none where it has no elements.
    pub elements: Vec<ElementName>,
    /// The cell shapes it takes.
    pub cells: Vec<String>,
    /// The fields of case, plan and spec that it reads.
    pub reads: Vec<String>,
    /// What only it has to be told, in the field of the spec that has its name.
    pub parameters: Vec<ParameterDocument>,
}

/// A parameter of a method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ParameterDocument {
    /// As it stands in the spec, with its unit.
    pub name: String,
    pub meaning: String,
    /// As JSON.
    pub default: serde_json::Value,
    /// As text, e.g. `(0, 100]` or `static | backward_euler`.
    pub range: String,
}

/// What is told of each method that is built.
fn documents() -> impl Iterator<Item = MethodDocument> {
    [
        fem_linear::document(),
        mtm::document(),
        mtm_ti::document(),
        msm::document(),
        dvs::document(),
        thickness_warp::document(),
    ]
    .into_iter()
}

/// The methods that are built.
pub fn available_methods() -> MethodList {
    MethodList {
        methods: documents().map(MeasuredMethod::of).collect(),
        auto: WHY_LINEAR.to_owned(),
        response: ResponseMethod {
            methods: vec![MethodName::FemLinear, MethodName::MtmTi],
            columns_per_segment: COLUMNS_PER_SEGMENT as u32,
            nonlinearity_estimate: "0.15 d^2 / h + 2.7 h (1 - cos theta): d the largest movement in mm of a \
                segment against another or against what stays, h the median distance in mm from the skin to \
                the nearest held node, theta the largest rotation; an order of magnitude"
                .to_owned(),
            linear_range_mm: LINEAR_RANGE_MM,
        },
        optimise: OptimiseMethod {
            methods: vec![MethodName::FemLinear, MethodName::MtmTi],
            minimises: "sum of (residual / sigma_mm)^2 over translations and angles within their bounds, by \
                Levenberg and Marquardt's method from rest, on a response of the segments"
                .to_owned(),
            certainty: "(J^T J)^-1 of the parameters that are not at a bound, J the derivative of residual / \
                sigma_mm: right where errors are independent with standard deviation sigma_mm"
                .to_owned(),
            undetermined_below: UNDETERMINED,
        },
    }
}

fn parameter(
    name: &str,
    meaning: &str,
    default: serde_json::Value,
    range: &str,
) -> ParameterDocument {
    ParameterDocument {
        name: name.to_owned(),
        meaning: meaning.to_owned(),
        default,
        range: range.to_owned(),
    }
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| (*word).to_owned()).collect()
}
