//! List of the available methods and their uses.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::describe;
use super::document::MethodDocument;
use super::measured::{self, MeasuredDocument};
use super::name::{MethodName, WHY_ESTIMATED};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::optimisation::UNDETERMINED;
use mechanics::prediction::MethodKind;
use mechanics::response::COLUMNS_PER_SEGMENT;
use mechanics::response::linearity::LINEAR_RANGE_MM;

/// Of a method that is newer than the built-in study.
const NOT_MEASURED: &str = "the built-in study has no row of this method";

/// Refuses, for plan responses, a method whose skin is not linear in the movements.
pub fn check_linear(method: MethodName, at: &Pointer, faults: &mut Faults) {
    if !method.chosen().properties().is_linear {
        let names: Vec<String> =
            linear().iter().map(|method| format!("`{}`", method.name())).collect();
        let detail = format!("responses are built by {}", names.join(" and "));
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
    }
}

/// The methods whose skin is linear in the movements.
fn linear() -> Vec<MethodName> {
    let linear = MethodKind::ALL.iter().filter(|method| method.properties().is_linear);
    linear.map(|method| MethodName::Named(*method)).collect()
}

/// The response of `GET /v1/methods`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodList {
    pub methods: Vec<MeasuredMethod>,
    /// The choice of `auto`, and why.
    pub auto: String,
    pub response: ResponseMethod,
    pub optimise: OptimiseMethod,
}

/// How jobs of kind `optimise` find a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptimiseMethod {
    /// The methods whose skin is linear in the movements.
    pub methods: Vec<MethodName>,
    /// The objective and its minimisation.
    pub minimises: String,
    /// How `standard_error` and `covariance` are computed.
    pub certainty: String,
    /// A combination of parameters is undetermined if it moves the targets by less than this share of
    /// the strongest one.
    pub undetermined_below: f64,
}

/// Plan responses, built by jobs of kind `response`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponseMethod {
    /// The linear ones.
    pub methods: Vec<MethodName>,
    pub columns_per_segment: u32,
    /// How `nonlinearity_estimate_mm` of an applied plan is computed.
    pub nonlinearity_estimate: String,
    /// The estimate above which a result is outside the linear range.
    pub linear_range_mm: f64,
}

/// A model with its measured speed and accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasuredMethod {
    #[serde(flatten)]
    pub method: MethodDocument,
    /// The results of the built-in study; its reference solutions, machine and command are in
    /// docs/speed-and-accuracy.md.
    pub measured: Vec<MeasuredDocument>,
    /// Why `measured` is empty, if it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub not_measured: Option<String>,
}

impl MeasuredMethod {
    fn of(method: MethodDocument) -> Self {
        let measured = measured::measured(method.name.name());
        MeasuredMethod::with(method, measured)
    }

    /// A method with these rows of the table, or the reason for none.
    pub(super) fn with(method: MethodDocument, measured: Vec<MeasuredDocument>) -> Self {
        let not_measured = measured.is_empty().then(|| NOT_MEASURED.to_owned());
        MeasuredMethod { method, measured, not_measured }
    }
}

/// The available methods.
pub fn available_methods() -> MethodList {
    MethodList {
        methods: MethodKind::ALL.iter().map(|method| MeasuredMethod::of(describe(*method))).collect(),
        auto: WHY_ESTIMATED.to_owned(),
        response: ResponseMethod {
            methods: linear(),
            columns_per_segment: COLUMNS_PER_SEGMENT as u32,
            nonlinearity_estimate: "of order 1: the second-order term, sampled for each segment along and about each \
                axis and added up, times what probes of the skin measure of all together over the same of each alone; \
                unknown of quadratic tetrahedra and of fibres that only pull. Of order 2: the third-order \
                term, sampled likewise"
                .to_owned(),
            linear_range_mm: LINEAR_RANGE_MM,
        },
        optimise: OptimiseMethod {
            methods: linear(),
            minimises: "sum of (residual / sigma_mm)^2 over translations and angles within their bounds, by \
                Levenberg and Marquardt's method from rest, on a response of the segments and of growth; constants of \
                tissue by steps of Gauss and Newton, with a response each"
                .to_owned(),
            certainty: "(J^T J)^-1 of the parameters not at a bound, and of growth and constants in any case, J the derivative of residual / \
                sigma_mm: correct for independent errors with standard deviation sigma_mm"
                .to_owned(),
            undetermined_below: UNDETERMINED,
        },
    }
}
