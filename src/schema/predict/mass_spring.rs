//! What only the mass-spring model has to be told.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::mass_spring::{MassSpringSettings, Search};

/// Iterations allowed at most, of either search.
const MOST_ITERATIONS: u32 = 1_000_000;
/// Newton's steps, where the spec does not say.
pub const NEWTON_ITERATIONS: u32 = 500;
/// Sweeps over all nodes, where the spec does not say.
pub const DIRECT_ITERATIONS: u32 = 50_000;

/// How the springs are brought to rest; only with the method `msm`.
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

/// How rest is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum EquilibriumName {
    /// Newton's method with a line search on the energy.
    #[default]
    Newton,
    /// Node by node, each to where its springs would have it: the papers' way.
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
