//! The spec of a conformation: the template with its skin and bone, the patient's, landmarks, and bounds of node movement.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::template::TemplateDocument;
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::repair::RepairDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::{check_keys, check_tags};
use mechanics::conformation::Start;

/// `conform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ConformKind {
    #[default]
    Conform,
}

/// A template mesh conformed to a patient by landmarks, surfaces, or both. Surfaces alone do not determine single
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
    /// The map of the template's muscles and uniform fibres to the patient; fibres in arrays move with the mesh.
    #[serde(default, skip_serializing_if = "MuscleMapName::is_default")]
    pub muscles_by: MuscleMapName,
    #[serde(default)]
    pub repair: RepairDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// The surfaces of a patient, in one frame, which may differ from that of the template.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PatientDocument {
    /// The id of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin: Option<String>,
    /// All bone of the segments and of `fixed` of the template.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub bone: Option<String>,
}

/// A point of both, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TemplateLandmarkDocument {
    pub template_mm: Triple,
    pub patient_mm: Triple,
}

/// The initial alignment of the template with the patient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ConformStartName {
    /// Three or more landmarks, else principal axes or boxes, whichever leaves less.
    #[default]
    Auto,
    Landmarks,
    /// Centres, sizes and principal axes of the skins aligned.
    Inertia,
    /// Bounding boxes of the skins aligned, without rotation.
    Boxes,
}

/// The map of muscles from the template to the patient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MuscleMapName {
    /// That of the mesh.
    #[default]
    Conformation,
    /// The thin-plate spline through all landmarks, at least four and not coplanar (Kim et al. 2012).
    Landmarks,
}

impl MuscleMapName {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
    fn is_default(&self) -> bool {
        *self == MuscleMapName::Conformation
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
    /// Adds its faults; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        check_keys(&self.landmarks, &at.key("landmarks"), limits, faults);
        self.template.check(&at.key("template"), limits, faults);
        self.repair.check(&at.key("repair"), faults);
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
        let muscles = root.key("template").key("muscles");
        for (index, muscle) in self.template.muscles.iter_mut().enumerate() {
            let at = muscles.index(index).key("surface");
            found.extend(muscle.surface.as_mut().map(|surface| (at, surface)));
        }
        found
    }
}
