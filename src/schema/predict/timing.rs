//! The wall time of a job by phases.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Wall time of each phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimingDocument {
    /// From acceptance to start; absent in results of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub queue_s: Option<f64>,
    pub validate_s: f64,
    pub mesh_s: f64,
    pub assemble_s: f64,
    pub solve_s: f64,
    /// Of error estimates; 0 in results older than these.
    #[serde(default)]
    pub estimate_s: f64,
    pub contact_s: f64,
    pub surface_s: f64,
    pub compare_s: f64,
    /// Of a correction by a learned model, with its file; 0 without one.
    #[serde(default)]
    pub correction_s: f64,
    pub write_s: f64,
    pub total_s: f64,
}
