//! A surface scan of the face, of a camera, as skin over the bone of a CT.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::compare::document::PlaceDocument;
use crate::schema::plan::movement::{MovementContext, MovementDocument};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_keys;
use crate::schema::{Matrix4x4, Triple};
use mechanics::anatomy::Closing;
use mechanics::anatomy::skin_scan::FittedScan;
use mechanics::osteotomy::Osteotomy;
use mechanics::registration::RigidTransform;

const MM2_IN_CM2: f64 = 100.0;

/// A surface scan that replaces the skin of the CT where it covers it; it is registered rigidly first, by
/// iterative closest point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SkinScanDocument {
    /// The id of an uploaded surface, open or closed, whose triangles face outwards.
    pub mesh: String,
    /// At least three corresponding points of scan and CT, if the two are not near each other already.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, ScanLandmarkDocument>,
    /// Restricts the registration to this part of the skin of the CT, such as the face above a mouth that is open in the CT.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mask: Option<PlaceDocument>,
    /// A segment of the osteotomy that is moved before meshing: a jaw that was open in the CT and closed for the
    /// camera. Plans start from there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub jaw: Option<ClosedJawDocument>,
}

/// The movement that closes a jaw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ClosedJawDocument {
    /// A segment of the osteotomy.
    pub segment: String,
    pub movement: MovementDocument,
}

/// A pair of corresponding points, of the scan as in its file, and of the CT.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScanLandmarkDocument {
    pub scan_mm: Triple,
    pub ct_mm: Triple,
}

/// The registration of a surface scan, and the remaining distance to the skin of the CT.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FittedScanDocument {
    /// Of the scan into the CT, both in LPS if their frames are known.
    pub matrix4x4: Matrix4x4,
    pub iterations: u64,
    /// Distances from the scan to the skin of the CT, in its field of view and in the mask, by area.
    pub mean_mm: f64,
    pub median_mm: f64,
    pub p95_mm: f64,
    /// The share of outliers, 0 to 1.
    pub share_above_3_mm: f64,
    /// The compared area, and that of the whole scan.
    pub compared_cm2: f64,
    pub area_cm2: f64,
}

impl SkinScanDocument {
    pub(super) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let landmarks = at.key("landmarks");
        check_keys(&self.landmarks, &landmarks, limits, faults);
        let count = self.landmarks.len();
        if (1..3).contains(&count) {
            let detail =
                format!("a registration by landmarks needs at least 3 of them, here are {count}");
            faults.add(&landmarks, ErrorCode::AlignmentFailed, detail);
        }
        if let Some(mask) = &self.mask {
            mask.check(&at.key("mask"), faults);
        }
    }
}

impl ClosedJawDocument {
    /// The segment by its number and its movement; pointers start at `at`.
    pub(super) fn to_closing(
        &self,
        at: &Pointer,
        osteotomy: &Osteotomy,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Option<Closing> {
        let movement = self.movement.to_movement(&at.key("movement"), context, faults)?;
        context.check_whole(&at.key("movement"), &movement, faults);
        let name = self.segment.trim();
        let segment = osteotomy.segments().iter().position(|segment| segment.name == name);
        if segment.is_none() {
            let detail = format!("the osteotomy has no segment {name:?}");
            faults.add(&at.key("segment"), ErrorCode::UnknownSegment, detail);
        }
        let movement = RigidTransform::from_matrix4(&movement.matrix4());
        Some(Closing { segment: segment?, movement })
    }
}

impl From<&FittedScan> for FittedScanDocument {
    fn from(found: &FittedScan) -> Self {
        let left = &found.left;
        FittedScanDocument {
            matrix4x4: Matrix4x4(found.transform.matrix4()),
            iterations: found.iterations as u64,
            mean_mm: left.mean,
            median_mm: left.median,
            p95_mm: left.p95,
            share_above_3_mm: left.outliers,
            compared_cm2: left.area / MM2_IN_CM2,
            area_cm2: left.whole / MM2_IN_CM2,
        }
    }
}
