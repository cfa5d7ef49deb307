//! What became of virtual patients when they were made.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::learning::Cohort;
use mechanics::learning::virtual_cohort::Redrawn;
use mechanics::mesh::Warning;

/// What became of virtual patients when they were made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MadeCohortDocument {
    /// Of each patient the area of tissue that presses on what it touches, of generic faces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub contact_mm2: Option<Vec<f64>>,
    /// Draws of patients whose tissue found no rest, in truth or in a model, and who were drawn again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub redrawn: Vec<RedrawnDocument>,
}

/// A draw of a patient that was not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RedrawnDocument {
    pub patient: String,
    pub why: String,
}

impl MadeCohortDocument {
    pub fn new(cohort: &Cohort, contact_mm2: Option<Vec<f64>>, redrawn: &[Redrawn]) -> Self {
        let again = |own: &Redrawn| RedrawnDocument {
            patient: cohort.cases[own.patient].name.clone(),
            why: own.why.clone(),
        };
        MadeCohortDocument { contact_mm2, redrawn: redrawn.iter().map(again).collect() }
    }

    /// Patients that were drawn again are others than those of the seed, which is told.
    pub fn warning(&self) -> Option<Warning> {
        let RedrawnDocument { patient, why } = self.redrawn.first()?;
        let count = self.redrawn.len();
        let detail = format!(
            "{count} draws of virtual patients found no rest and were drawn again, the first of {patient}: {why}; `virtual.redrawn` has all"
        );
        Some(Warning::new("virtual-patient-redrawn", detail).with("draws", count as f64))
    }
}
