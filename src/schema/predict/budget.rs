//! The budget of a job: time and memory.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;

/// The limits of a job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BudgetDocument {
    #[serde(default = "default_wall_s")]
    #[schema(default = 600.0, exclusive_minimum = 0.0)]
    pub wall_s: f64,
    #[serde(default = "default_memory_mb")]
    #[schema(default = 4000.0, minimum = 1.0)]
    pub memory_mb: f64,
}

impl BudgetDocument {
    /// Adds its faults, at its place.
    pub fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        faults.check_range(&at.key("wall_s"), self.wall_s, 1e-3..=limits.wall_s, "s");
        faults.check_range(&at.key("memory_mb"), self.memory_mb, 1.0..=limits.memory_mb, "MB");
    }
}

fn default_wall_s() -> f64 {
    600.0
}

fn default_memory_mb() -> f64 {
    4000.0
}

impl Default for BudgetDocument {
    fn default() -> Self {
        BudgetDocument { wall_s: default_wall_s(), memory_mb: default_memory_mb() }
    }
}
