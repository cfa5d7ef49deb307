//! The spec of a reproduction: bone before and after an operation, the fixed base, and the moved segments.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::PlanDocument;
use crate::schema::Triple;
use crate::schema::case::bone_landmark::{BoneLandmarkOfCaseDocument, check_bone_landmarks};
use crate::schema::case::norm::{NormDocument, NormDocuments, check_norms};
use crate::schema::code::ErrorCode;
use crate::schema::compare::document::{MeshReference, PlaceDocument, StartName};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::{check_keys, check_tags};

/// `reproduce`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ReproduceKind {
    #[default]
    Reproduce,
}

/// The movements that an operation performed, found from bone before and after it. The result is a plan in the frame
/// before the operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReproduceDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: ReproduceKind,
    /// All bone before the operation.
    pub before: MeshReference,
    /// All bone after it, in the frame of its scan.
    pub after: MeshReference,
    /// Bone that was not operated on.
    pub base: BaseDocument,
    pub segments: Vec<ReproducedSegmentDocument>,
    /// The plan, in the frame before the operation: each segment is compared with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned: Option<PlanDocument>,
    /// Named points of bone before the operation, each with its segment, for cephalometric measures before, planned and performed.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bone_landmarks: BTreeMap<String, BoneLandmarkOfCaseDocument>,
    /// Norms of these measures, by their names; they replace built-in ones.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(value_type = BTreeMap<String, NormDocument>)]
    pub norms: NormDocuments,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// The registration of both scans.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BaseDocument {
    /// The part of `before` not operated on; by default all of `before` is used, of which little may have moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mask: Option<PlaceDocument>,
    /// Initial position of the scan after the operation; it alone is tried. Absent: as it lies (`none`), and where that leaves more than
    /// a twentieth of the base 1 mm away, `boxes` and `inertia` too; `reproduction.base.start` has the one taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub start: Option<StartName>,
    /// At least three, for a `start` of `landmarks`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, BoneLandmarkDocument>,
}

/// A segment that moved: a part of `before`, or a separate surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReproducedSegmentDocument {
    pub name: String,
    /// Its surface before the operation; absent: the part of `before` in `mask`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub before: Option<MeshReference>,
    /// Its surface after the operation; absent: it is searched for in all of `after`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub after: Option<MeshReference>,
    /// Restricts the registration to this part of the segment before the operation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mask: Option<PlaceDocument>,
    /// `none`: as if it had not moved. `boxes` and `inertia` align the segment with its own `after`.
    #[serde(default)]
    pub start: StartName,
    /// At least three, for a `start` of `landmarks`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, BoneLandmarkDocument>,
}

/// A pair of corresponding points of bone in both scans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoneLandmarkDocument {
    pub before_mm: Triple,
    pub after_mm: Triple,
}

/// The initial positions of base and segments.
struct Started<'a> {
    start: StartName,
    landmarks: &'a BTreeMap<String, BoneLandmarkDocument>,
}

impl ReproduceDocument {
    /// Adds its faults; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        let base = at.key("base");
        if let Some(mask) = &self.base.mask {
            mask.check(&base.key("mask"), faults);
        }
        let BaseDocument { start, landmarks, .. } = &self.base;
        let start = start.unwrap_or_default();
        Started { start, landmarks }.check(&base, limits, faults);
        let segments = self.segments.iter().map(|segment| segment.name.trim()).collect();
        let landmarks = at.key("bone_landmarks");
        check_bone_landmarks(&self.bone_landmarks, &segments, &landmarks, limits, faults);
        check_norms(&self.norms, &at.key("norms"), limits, faults);
        let at = at.key("segments");
        faults.check_length(&at, self.segments.len(), limits.list_entries as usize);
        if self.segments.is_empty() {
            faults.add(&at, ErrorCode::MissingField, "at least one segment is reproduced");
        }
        let mut names = BTreeSet::new();
        for (index, segment) in self.segments.iter().enumerate() {
            let at = at.index(index);
            segment.check(&at, limits, faults);
            if !names.insert(segment.name.trim()) {
                let detail = format!("segment `{}` is named more than once", segment.name.trim());
                faults.add(&at.key("name"), ErrorCode::DuplicateName, detail);
            }
        }
    }

    /// Every mesh that it names, with its place.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let mut found = vec![
            (root.key("before").key("mesh"), &mut self.before.mesh),
            (root.key("after").key("mesh"), &mut self.after.mesh),
        ];
        for (index, segment) in self.segments.iter_mut().enumerate() {
            let at = root.key("segments").index(index);
            let own = [("before", &mut segment.before), ("after", &mut segment.after)];
            for (name, mesh) in own {
                found.extend(mesh.iter_mut().map(|m| (at.key(name).key("mesh"), &mut m.mesh)));
            }
        }
        found
    }
}

impl ReproducedSegmentDocument {
    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        faults.check_name(&at.key("name"), self.name.trim(), limits.name_characters as usize);
        if self.before.is_none() && self.mask.is_none() {
            let detail = "a segment is a separate surface, `before`, or the part in a `mask`";
            faults.add(at, ErrorCode::MissingField, detail);
        }
        if let Some(mask) = &self.mask {
            mask.check(&at.key("mask"), faults);
        }
        if matches!(self.start, StartName::Boxes | StartName::Inertia) && self.after.is_none() {
            let detail = "this start aligns the segment with its own `after`, which is not given";
            faults.add(&at.key("start"), ErrorCode::MissingField, detail);
        }
        Started { start: self.start, landmarks: &self.landmarks }.check(at, limits, faults);
    }
}

impl Started<'_> {
    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let place = at.key("landmarks");
        let count = self.landmarks.len();
        check_keys(self.landmarks, &place, limits, faults);
        let wanted = self.start == StartName::Landmarks;
        if wanted && count < 3 {
            let detail = format!("a start by landmarks needs at least 3 of them, here are {count}");
            faults.add(&place, ErrorCode::AlignmentFailed, detail);
        }
        if !wanted && count > 0 {
            let detail = "landmarks are read where `start` is `landmarks`";
            faults.add(&place, ErrorCode::UnknownField, detail);
        }
    }
}
