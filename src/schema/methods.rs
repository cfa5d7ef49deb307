//! `GET /v1/methods`: the ways of modelling, by the names a spec may give.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fault::{Faults, Pointer};
use crate::prediction::ElementChoice;
use crate::response::COLUMNS_PER_SEGMENT;
use crate::response::linearity::LINEAR_RANGE_MM;

/// Why `auto` is what it is.
pub const WHY_LINEAR: &str = "auto: fem_linear is the only model built so far";
/// Why a method that was asked for by name is used.
pub const WHY_ASKED: &str = "asked for by the spec";

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
    /// Mean dilatation for hex8 and wedge6, the plain element for tet4.
    #[default]
    Auto,
    /// Full integration for every shape.
    Plain,
    MeanDilatation,
    Stabilised,
    Quadratic,
}

impl MethodName {
    /// Whether it is built.
    pub fn is_available(self) -> bool {
        matches!(self, MethodName::Auto | MethodName::FemLinear)
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
        let detail = "this method is not available; `auto` and `fem_linear` are";
        faults.add(at, "method-not-available", detail);
    }
}

/// The element of the path; refuses one that is not built.
pub fn check_element(
    element: ElementName,
    at: &Pointer,
    faults: &mut Faults,
) -> Option<ElementChoice> {
    match element {
        ElementName::Auto => Some(ElementChoice::Auto),
        ElementName::Plain => Some(ElementChoice::Plain),
        ElementName::MeanDilatation => Some(ElementChoice::MeanDilatation),
        ElementName::Stabilised | ElementName::Quadratic => {
            let detail = "this element is not available; `auto`, `plain` and `mean_dilatation` are";
            faults.add(at, "method-not-available", detail);
            None
        }
    }
}

/// The answer of `GET /v1/methods`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodList {
    pub methods: Vec<MethodDocument>,
    /// What `auto` chooses, and why.
    pub auto: String,
    pub response: ResponseMethod,
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

/// A way of modelling that a spec may ask for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodDocument {
    pub name: MethodName,
    pub title: String,
    /// The elements it knows.
    pub elements: Vec<ElementName>,
    /// The cell shapes it takes.
    pub cells: Vec<String>,
    /// The fields of case, plan and spec that it reads.
    pub reads: Vec<String>,
}

/// The methods that are built.
pub fn available_methods() -> MethodList {
    let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect();
    MethodList {
        methods: vec![MethodDocument {
            name: MethodName::FemLinear,
            title: "linear elasticity at small strain, finite elements of first order".to_owned(),
            elements: vec![ElementName::Auto, ElementName::Plain, ElementName::MeanDilatation],
            cells: words(&["tet4", "hex8", "wedge6"]),
            reads: words(&[
                "case.segments",
                "case.fixed",
                "case.sliding",
                "case.materials.young_modulus_kpa",
                "case.materials.poisson_ratio",
                "case.materials.density_g_per_cm3",
                "plan.segments",
                "plan.prescribed",
                "plan.loads",
                "spec.contact",
                "spec.element",
                "spec.materials",
                "spec.tolerance.relative_residual",
                "spec.budget",
            ]),
        }],
        auto: WHY_LINEAR.to_owned(),
        response: ResponseMethod {
            methods: vec![MethodName::FemLinear],
            columns_per_segment: COLUMNS_PER_SEGMENT as u32,
            nonlinearity_estimate: "0.15 d^2 / h + 2.7 h (1 - cos theta): d the largest movement in mm of a \
                segment against another or against what stays, h the median distance in mm from the skin to \
                the nearest held node, theta the largest rotation; an order of magnitude"
                .to_owned(),
            linear_range_mm: LINEAR_RANGE_MM,
        },
    }
}
