//! The tolerance of the solver.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The accuracy of the solution of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ToleranceDocument {
    /// |f - K u| / |f_D| of the free rows; in [1e-14, 1e-2]. With pressures, those of both equations,
    /// a residual volume counted as the nodal forces of its pressure.
    #[serde(default = "usual_residual")]
    #[schema(default = 1e-8, minimum = 1e-14, maximum = 1e-2)]
    pub relative_residual: f64,
}

fn usual_residual() -> f64 {
    1e-8
}

impl Default for ToleranceDocument {
    fn default() -> Self {
        ToleranceDocument { relative_residual: usual_residual() }
    }
}
