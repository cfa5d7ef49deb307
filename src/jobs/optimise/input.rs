//! Input of inverse planning.

use serde::{Deserialize, Serialize};

use crate::schema::{CaseDocument, OptimiseDocument};

/// Inverse planning: the case in full beside the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OptimiseInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub case: CaseDocument,
    pub spec: OptimiseDocument,
}
