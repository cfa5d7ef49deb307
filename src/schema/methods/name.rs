//! The names of methods and of elements.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::ElementChoice;

/// Why `auto` is what it is.
pub const WHY_LINEAR: &str = "auto: fem_linear, until something chooses between models";
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
