//! The budget of a job: time and memory.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a job may take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BudgetDocument {
    #[serde(default = "usual_wall")]
    #[schema(default = 600.0, exclusive_minimum = 0.0)]
    pub wall_s: f64,
    #[serde(default = "usual_memory")]
    #[schema(default = 4000.0, minimum = 1.0)]
    pub memory_mb: f64,
}

fn usual_wall() -> f64 {
    600.0
}

fn usual_memory() -> f64 {
    4000.0
}

impl Default for BudgetDocument {
    fn default() -> Self {
        BudgetDocument { wall_s: usual_wall(), memory_mb: usual_memory() }
    }
}
