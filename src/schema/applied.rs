//! A plan applied to a response: what is asked, and what is answered.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Triple, WarningDocument};
use crate::schema::plan::document::PlanDocument;
use mechanics::mesh::Vector;
use mechanics::response::Nonlinearity;
use mechanics::response::linearity::LINEAR_RANGE_MM;

/// The body of `POST /v1/cases/{id}/response/apply`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ApplyDocument {
    pub plan: PlanDocument,
}

/// The displacement of the skin for a plan, and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AppliedDocument {
    /// The job that built the response.
    pub job: String,
    /// Nodes of the volume mesh, ascending.
    pub node_ids: Vec<u32>,
    /// For each of them.
    #[schema(value_type = Vec<Triple>)]
    pub displacement_mm: Vec<[f32; 3]>,
    #[serde(flatten)]
    pub summary: AppliedSummary,
    pub warnings: Vec<WarningDocument>,
    /// Codes of warnings that were not looked for: `skin-overlaps` without `check_skin`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_measured: Vec<String>,
}

/// What is told beside the displacement, in headers where the body is binary.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AppliedSummary {
    /// The largest displacement of a skin node.
    pub max_mm: f64,
    /// The largest rotation of a segment.
    pub largest_rotation_deg: f64,
    /// An order of magnitude of what linearity leaves out, mean over the skin.
    pub nonlinearity_estimate_mm: f64,
    /// Whether the estimate is at most 0.5 mm.
    pub within_linear_range: bool,
}

impl AppliedSummary {
    pub fn new(displacement: &[Vector], nonlinearity: &Nonlinearity) -> Self {
        let squared = displacement.iter().map(Vector::norm_squared).fold(0.0, f64::max);
        AppliedSummary {
            max_mm: squared.sqrt(),
            largest_rotation_deg: nonlinearity.largest_rotation.to_degrees(),
            nonlinearity_estimate_mm: nonlinearity.estimate,
            within_linear_range: nonlinearity.is_within_linear_range(),
        }
    }

    /// The word of warning that goes with an answer outside the linear range.
    pub const OUTSIDE: &'static str = "outside-linear-range";

    pub fn warnings(&self) -> Vec<WarningDocument> {
        if self.within_linear_range {
            return Vec::new();
        }
        let detail = format!(
            "linearity leaves out about {:.1} mm, more than {LINEAR_RANGE_MM} mm",
            self.nonlinearity_estimate_mm
        );
        vec![WarningDocument {
            code: Self::OUTSIDE.to_owned(),
            detail,
            numbers: serde_json::Map::new(),
        }]
    }
}
