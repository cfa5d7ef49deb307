//! The spec of a conformation: the template with its skin and bone, the patient's, landmarks, and how far nodes may go.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::conformation::Start;

/// `conform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ConformKind {
    #[default]
    Conform,
}

/// A template mesh brought to a patient: by landmarks, by surfaces, or by both. Surfaces alone claim nothing about single
/// nodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ConformDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: ConformKind,
    pub template: TemplateDocument,
    #[serde(default)]
    pub patient: PatientDocument,
    /// By name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, TemplateLandmarkDocument>,
    #[serde(default)]
    pub start: ConformStartName,
    #[serde(default)]
    pub repair: RepairDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// A volume mesh, and which of its nodes lie on what.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TemplateDocument {
    /// The id of the volume mesh.
    pub mesh: String,
    /// The node set of the skin.
    pub skin: String,
    /// By the names of segments: the node sets that lie on them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub segments: BTreeMap<String, String>,
    /// The node set on bone that stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fixed: Option<String>,
}

/// The surfaces of a patient, in one frame; that of the template may be another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PatientDocument {
    /// The id of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin: Option<String>,
    /// All bone that the segments and `fixed` of the template lie on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub bone: Option<String>,
}

/// The same place of both, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TemplateLandmarkDocument {
    pub template_mm: Triple,
    pub patient_mm: Triple,
}

/// How the template is first brought to the patient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ConformStartName {
    /// Landmarks where there are three or more, principal axes otherwise.
    #[default]
    Auto,
    Landmarks,
    /// Centres, sizes and principal axes of the skins together.
    Inertia,
    /// Boxes around the skins together; nothing is turned.
    Boxes,
}

/// How far a repair may move nodes, so that every cell is valid in every point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RepairDocument {
    /// Of nodes on the boundary; on skin and bone along the surface only. 0 to 10 mm.
    #[serde(default = "one")]
    #[schema(default = 1.0)]
    pub boundary_mm: f64,
    /// Of other nodes, 0 to 10 mm.
    #[serde(default = "three")]
    #[schema(default = 3.0)]
    pub inner_mm: f64,
}

fn one() -> f64 {
    1.0
}

fn three() -> f64 {
    3.0
}

impl Default for RepairDocument {
    fn default() -> Self {
        RepairDocument { boundary_mm: one(), inner_mm: three() }
    }
}

impl From<ConformStartName> for Start {
    fn from(name: ConformStartName) -> Self {
        match name {
            ConformStartName::Auto => Start::Auto,
            ConformStartName::Landmarks => Start::Landmarks,
            ConformStartName::Inertia => Start::Inertia,
            ConformStartName::Boxes => Start::Boxes,
        }
    }
}

impl ConformDocument {
    /// Adds what is wrong with it; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        let place = at.key("landmarks");
        faults.check_length(&place, self.landmarks.len(), limits.map_entries as usize);
        for name in self.landmarks.keys() {
            faults.check_name(&place.key(name), name, limits.name_characters as usize);
        }
        let place = at.key("template").key("segments");
        for name in self.template.segments.keys() {
            faults.check_name(&place.key(name), name, limits.name_characters as usize);
        }
        let repair = at.key("repair");
        let RepairDocument { boundary_mm, inner_mm } = self.repair;
        faults.check_range(&repair.key("boundary_mm"), boundary_mm, 0.0..=10.0, "mm");
        faults.check_range(&repair.key("inner_mm"), inner_mm, 0.0..=10.0, "mm");
        let has_surface = self.patient.skin.is_some() || self.patient.bone.is_some();
        if !has_surface && self.landmarks.is_empty() {
            let detail = "there is neither a skin nor bone nor a landmark to conform to";
            faults.add(&at.key("patient"), ErrorCode::MissingField, detail);
        }
    }

    /// Every mesh that it names, with its place.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let patient = root.key("patient");
        let mut found = vec![(root.key("template").key("mesh"), &mut self.template.mesh)];
        found.extend(self.patient.skin.iter_mut().map(|id| (patient.key("skin"), id)));
        found.extend(self.patient.bone.iter_mut().map(|id| (patient.key("bone"), id)));
        found
    }
}
