//! The result of a reproduction: a plan, and the fit of bone before the operation to bone after it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::compare::document::StartName;
use crate::schema::compare::result::StandardErrorDocument;
use crate::schema::{Matrix4x4, PlanDocument, Triple};
use mechanics::registration::SurfaceAlignment;

/// The movements of an operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReproductionDocument {
    /// The movements as a plan in the frame before the operation, ready to be predicted.
    pub plan: PlanDocument,
    /// The registration of the scan after the operation onto the one before it.
    pub base: BaseFitDocument,
    /// In the order of the spec.
    pub segments: Vec<PerformedDocument>,
}

/// The registration of the scans.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BaseFitDocument {
    /// From the scan after the operation to the one before it: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    /// The initial position from which it was found: the stated one, or the best of those tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub start: Option<StartName>,
    pub fit: FitDocument,
}

/// A segment's movement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PerformedDocument {
    pub name: String,
    /// In the frame before the operation: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub rotation_deg: f64,
    /// Axis of the rotation, right-handed; zero without rotation.
    pub axis: Triple,
    /// The centroid of the segment before the operation, by area.
    pub centre_mm: Triple,
    /// Its displacement.
    pub displacement_mm: Triple,
    /// Of this movement, from the shapes and residuals of base and segment together.
    #[serde(default)]
    pub standard_error: StandardErrorDocument,
    pub fit: FitDocument,
    /// From the plan, if it moves the segment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub from_planned: Option<DeviationDocument>,
}

/// The deviation of the performed from the planned movement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DeviationDocument {
    pub rotation_deg: f64,
    /// Of the centroid of the segment.
    pub displacement_mm: Triple,
}

/// The fit of two surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FitDocument {
    /// Root mean square distance of the pairs used, in mm.
    pub rms_mm: f64,
    /// Share of the points with a counterpart that remain more than 1 mm from it, 0 to 1.
    pub share_above_1_mm: f64,
    /// Sample points on the registered bone, and the number of them used.
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
