//! Nonlinear finite elements: parameters and description.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};
use serde_json::json;
use utoipa::ToSchema;

use super::document::{Description, ParameterDocument};
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::prediction::Advance;

/// The most load steps.
const MOST_LOAD_STEPS: u32 = 100;

/// Load steps of a movement at finite strain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FemNonlinearDocument {
    /// Movement, loads, growth and activations are applied in this number of equal steps, each solved to equilibrium, with a row
    /// each in `load_steps` of the result. Default: all of it at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 100)]
    pub load_steps: Option<u32>,
}

impl FemNonlinearDocument {
    pub fn check(&self, at: &Pointer, faults: &mut Faults) {
        if let Some(steps) = self.load_steps {
            let range = 1.0..=f64::from(MOST_LOAD_STEPS);
            faults.check_range(&at.key("load_steps"), f64::from(steps), range, "");
        }
    }

    pub fn advance(&self) -> Advance {
        let steps = self.load_steps.and_then(NonZeroU32::new);
        steps.map_or(Advance::AtOnceOrInParts, Advance::InSteps)
    }
}

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "hyperelastic tissue at finite strain, finite elements",
        assumptions: &[
            "each region has its law; the default is neo-Hookean, W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J \
                with the Lame constants of Young's modulus and Poisson's ratio: no cell turns inside out, and turning is \
                no strain",
            "elements of first order that do not lock: tetrahedra share pressures at their nodes, hexahedra and wedges one in \
                each cell; plain ones lock above a Poisson ratio of 0.45, with a warning",
            "a wall that tissue slides on stays flat, and rotates with its segment; loads keep their direction",
            "if tissue has several equilibria, as compressed and creased tissue may, one of them is found",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.materials.law",
            "case.materials.fibre",
            "case.hounsfield",
            "case.muscles",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "plan.growth",
            "plan.activations",
            "spec.contact",
            "spec.element",
            "spec.fem_nonlinear",
            "spec.materials",
            "spec.membrane",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: vec![ParameterDocument {
            name: "load_steps".to_owned(),
            meaning: "equal steps in which movement, loads, growth and activations are applied, each solved to equilibrium"
                .to_owned(),
            default: json!(null),
            range: format!("[1, {MOST_LOAD_STEPS}]"),
        }],
    }
}
