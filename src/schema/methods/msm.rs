//! Mass-spring model: parameters and description.

use serde::{Deserialize, Serialize};
use serde_json::json;
use utoipa::ToSchema;

use super::document::{Description, ParameterDocument};
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::mass_spring::{MassSpringSettings, Search};

/// The most iterations, of either search.
const MOST_ITERATIONS: u32 = 1_000_000;
/// The default number of Newton's steps.
pub const NEWTON_ITERATIONS: u32 = 500;
/// The default number of sweeps over all nodes.
pub const DIRECT_ITERATIONS: u32 = 50_000;

/// The search of the equilibrium of springs; only with the method `msm`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MassSpringDocument {
    #[serde(default)]
    pub equilibrium: EquilibriumName,
    /// Default: 500 steps of `newton`, 50 000 sweeps of `direct`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 1000000)]
    pub max_iterations: Option<u32>,
}

/// The search of equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum EquilibriumName {
    /// Newton's method with a line search on the energy.
    #[default]
    Newton,
    /// Node by node, each to the equilibrium of its springs, as in the papers.
    Direct,
}

impl MassSpringDocument {
    pub fn to_settings(&self, at: &Pointer, faults: &mut Faults) -> MassSpringSettings {
        let (search, usual) = match self.equilibrium {
            EquilibriumName::Newton => (Search::Newton, NEWTON_ITERATIONS),
            EquilibriumName::Direct => (Search::Direct, DIRECT_ITERATIONS),
        };
        let most = self.max_iterations.unwrap_or(usual);
        let range = 1.0..=f64::from(MOST_ITERATIONS);
        faults.check_range(&at.key("max_iterations"), f64::from(most), range, "");
        MassSpringSettings { search, most_iterations: most as usize }
    }
}

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "springs along the edges of tetrahedra, in equilibrium",
        assumptions: &[
            "a spring has the stiffness E V / L^2, V the volume of the tetrahedra around it and L its length \
                (Van Gelder): only Young's modulus is used, and only its ratios matter if bone is moved",
            "a Poisson ratio of 1/4 on average, whatever the materials say: the bulk modulus is 2 E / 3 and \
                C1122 equals C1212 (Cauchy's symmetry) on every mesh; tissue, of 0.43 and above, loses volume \
                instead of moving the skin. The result has the warning `built-in-poisson-ratio`",
            "the result depends on the mesh: forces act along its edges only, and how \
                stiff it is in a direction depends on how it was meshed",
            "springs know lengths and not volumes: rotations cost nothing, and under large pressure the network \
                buckles sideways and cells are inverted (warning `cells-inverted`). There are then \
                several equilibria, and `newton` and `direct` may end in different ones",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.density_g_per_cm3",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.materials",
            "spec.msm",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: vec![
            ParameterDocument {
                name: "equilibrium".to_owned(),
                meaning: "equilibrium search: Newton's method with a line search on the energy, or node by \
                    node, each to the equilibrium of its springs"
                    .to_owned(),
                default: json!("newton"),
                range: "newton | direct".to_owned(),
            },
            ParameterDocument {
                name: "max_iterations".to_owned(),
                meaning: format!(
                    "steps or sweeps after which the solution ends without an equilibrium; default \
                     {NEWTON_ITERATIONS} with newton, {DIRECT_ITERATIONS} with direct"
                ),
                default: json!(NEWTON_ITERATIONS),
                range: "[1, 1000000]".to_owned(),
            },
        ],
    }
}
