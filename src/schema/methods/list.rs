//! The list of methods that are built, and of what they serve.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::document::MethodDocument;
use super::measured::{self, MeasuredDocument};
use super::name::{MethodName, WHY_LINEAR};
use super::{dvs, fem_linear, msm, mtm, mtm_ti, thickness_warp};
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::optimisation::UNDETERMINED;
use mechanics::response::COLUMNS_PER_SEGMENT;
use mechanics::response::linearity::LINEAR_RANGE_MM;

/// Refuses a method that is not built, naming those that are.
pub fn check_method(method: MethodName, at: &Pointer, faults: &mut Faults) {
    if !method.is_available() {
        let names: Vec<String> = documents().map(|row| format!("`{}`", row.name.name())).collect();
        let detail = format!("this method is not available; `auto` and {} are", names.join(", "));
        faults.add(at, "method-not-available", detail);
    }
}

/// Refuses, for plan responses, a method whose skin is not linear in the movements, or that has none of its own.
pub fn check_linear(method: MethodName, at: &Pointer, faults: &mut Faults) {
    let is_linear = matches!(method.chosen(), MethodName::FemLinear | MethodName::MtmTi);
    if method.is_available() && !is_linear {
        let detail = "responses are built by `fem_linear` and `mtm_ti`";
        faults.add(at, "method-not-available", detail);
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
        faults.add(&at.key(name), "method-mismatch", detail);
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
}

impl MeasuredMethod {
    fn of(method: MethodDocument) -> Self {
        MeasuredMethod { measured: measured::measured(method.name.name()), method }
    }
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
