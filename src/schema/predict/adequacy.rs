//! How the cheapest adequate model was chosen.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::{Accepted, Adequate, Considered};

/// The choice of the method `auto` with an accepted error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AdequacyDocument {
    /// The mean error over the skin that was accepted, in mm.
    pub accepted_mm: f64,
    /// Whether the estimate of the model that was taken is within it.
    pub met: bool,
    /// The model that was taken: `linear`, `corrected` or `finite_strain`.
    pub taken: String,
    /// Mean errors over the skin, estimated with the linear answer, in mm: what its mesh leaves out, and what linearity does.
    /// Absent where they are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub linearity_mm: Option<f64>,
    /// From the cheapest to the dearest.
    pub rungs: Vec<RungDocument>,
}

/// A model that was considered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RungDocument {
    pub name: String,
    /// The mean error over the skin that is expected of it, in mm; absent where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error_mm: Option<f64>,
    /// Time it was expected to take, and time it took, in s; `corrected` is the answer of `linear`.
    pub expected_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub spent_s: Option<f64>,
    /// Why it was out of the question.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub passed_over: Option<String>,
}

impl AdequacyDocument {
    pub fn new(accepted: &Accepted, adequate: &Adequate) -> Self {
        AdequacyDocument {
            accepted_mm: accepted.skin_mm,
            met: adequate.is_met,
            taken: adequate.rung.name().to_owned(),
            mesh_mm: adequate.errors.mesh_mm,
            linearity_mm: adequate.errors.linearity_mm,
            rungs: adequate.considered.iter().map(RungDocument::from).collect(),
        }
    }

    /// In words.
    pub fn why(&self) -> String {
        let taken = self.rungs.iter().find(|rung| rung.name == self.taken);
        let error = match taken.and_then(|rung| rung.error_mm) {
            Some(error) => format!("an expected mean error of {error:.3} mm over the skin"),
            None => "an error that is not known".to_owned(),
        };
        let verdict = match self.met {
            true => "the cheapest model within",
            false => "the most accurate one that was possible, short of",
        };
        format!("`{}` with {error} is {verdict} {} mm", self.taken, self.accepted_mm)
    }
}

impl From<&Considered> for RungDocument {
    fn from(considered: &Considered) -> Self {
        RungDocument {
            name: considered.rung.name().to_owned(),
            error_mm: considered.error_mm,
            expected_s: considered.expected_s,
            spent_s: considered.spent_s,
            passed_over: considered.passed_over.clone(),
        }
    }
}
