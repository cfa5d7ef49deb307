//! The answer of a reproduction: a plan, and how well bone before the operation lies on bone after it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::{Matrix4x4, PlanDocument, Triple};
use mechanics::registration::SurfaceAlignment;

/// What an operation did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReproductionDocument {
    /// The movements as a plan in the frame before the operation, ready to be predicted.
    pub plan: PlanDocument,
    /// The scan after the operation onto the one before it.
    pub base: BaseFitDocument,
    /// In the order of the spec.
    pub segments: Vec<PerformedDocument>,
}

/// How the scans were brought together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BaseFitDocument {
    /// Takes the scan after the operation to the one before it: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub fit: FitDocument,
}

/// A segment's movement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PerformedDocument {
    pub name: String,
    /// In the frame before the operation: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub rotation_deg: f64,
    /// About which it turned, right-handed; zero where it did not turn.
    pub axis: Triple,
    /// The middle of the segment before the operation, by area.
    pub centre_mm: Triple,
    /// How far that was moved.
    pub displacement_mm: Triple,
    pub fit: FitDocument,
    /// From the plan, where one is given that moves the segment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub from_planned: Option<DeviationDocument>,
}

/// What was performed beyond what was planned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DeviationDocument {
    pub rotation_deg: f64,
    /// Of the middle of the segment.
    pub displacement_mm: Triple,
}

/// How well surfaces lie on each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FitDocument {
    /// Root of the mean squared distance of the pairs that counted, in mm.
    pub rms_mm: f64,
    /// Of the points with something opposite, the share that is left more than 1 mm from it, 0 to 1.
    pub share_above_1_mm: f64,
    /// Points spread over the bone that decides, and how many of them counted.
    pub points: u64,
    pub pairs: u64,
    pub iterations: u64,
}

impl From<&SurfaceAlignment> for FitDocument {
    fn from(found: &SurfaceAlignment) -> Self {
        FitDocument {
            rms_mm: found.rms,
            share_above_1_mm: found.share_far,
            points: found.points as u64,
            pairs: found.pairs as u64,
            iterations: found.iterations as u64,
        }
    }
}
