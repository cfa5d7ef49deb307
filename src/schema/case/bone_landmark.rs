//! Landmarks of bone.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_keys;

/// Beyond the origin of any scanner in use.
const FARTHEST_MM: f64 = 1e8;

/// A named point of bone, which moves with its segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoneLandmarkOfCaseDocument {
    pub position_mm: Triple,
    /// The segment of the case it moves with; absent: it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
}

/// Adds the faults of the landmarks of bone at a place, of a document with these segments.
pub fn check_bone_landmarks(
    landmarks: &BTreeMap<String, BoneLandmarkOfCaseDocument>,
    segments: &BTreeSet<&str>,
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) {
    check_keys(landmarks, at, limits, faults);
    for (name, landmark) in landmarks {
        let at = at.key(name);
        for (axis, &coordinate) in landmark.position_mm.0.iter().enumerate() {
            let place = at.key("position_mm").index(axis);
            faults.check_range(&place, coordinate, -FARTHEST_MM..=FARTHEST_MM, "mm");
        }
        let segment = landmark.segment.as_deref().map(str::trim);
        if let Some(unknown) = segment.filter(|segment| !segments.contains(segment)) {
            let detail = format!("there is no segment `{unknown}`");
            faults.add(&at.key("segment"), ErrorCode::UnknownSegment, detail);
        }
    }
}
