//! Template of a conformation: its mesh, the node sets of its surfaces, and its tissue.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::CaseDocument;
use crate::schema::case::document::{
    LengthUnit, NormalDocument, RegionsDocument, SegmentDocument, SlidingDocument,
};
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::muscle::{MuscleContext, MuscleDocument, to_muscles};
use crate::schema::case::muscle_mixing::MuscleMixingDocument;
use crate::schema::case::selection::SelectionDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_keys;

/// A volume mesh, its node sets, and members of a case that are mapped to the patient.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TemplateDocument {
    /// The id of the volume mesh.
    pub mesh: String,
    /// The node set of the skin.
    pub skin: String,
    /// By the names of segments: their node sets.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub segments: BTreeMap<String, String>,
    /// The node set on fixed bone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fixed: Option<String>,
    /// Fixed node sets not on bone, such as at a cut of the mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<String>,
    /// Node sets that slide along a wall.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sliding: Vec<TemplateSlidingDocument>,
    /// By name: the node sets of parts of the skin.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub skin_regions: BTreeMap<String, String>,
    /// As in a case; the array moves with the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub regions: Option<RegionsDocument>,
    /// As in a case. Fibres in a `direction` become an array of the patient's mesh, rotated with the tissue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// As in a case, with lines, boxes and surfaces in the frame of the template. A `surface` or `box_mm` becomes a
    /// stored surface on the patient.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<MuscleDocument>,
    /// As in a case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub muscle_mixing: Option<MuscleMixingDocument>,
}

/// Sliding nodes of a template.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TemplateSlidingDocument {
    /// The node set.
    pub nodes: String,
    /// The segment that moves the wall. Absent: the wall stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
}

impl TemplateDocument {
    pub(super) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        for (member, names) in [("segments", &self.segments), ("skin_regions", &self.skin_regions)]
        {
            check_keys(names, &at.key(member), limits, faults);
        }
        let entries = limits.list_entries as usize;
        faults.check_length(&at.key("held"), self.held.len(), entries);
        faults.check_length(&at.key("sliding"), self.sliding.len(), entries);
        let context = MuscleContext { limits, surfaces: None };
        to_muscles(&self.muscles, &at.key("muscles"), context, faults);
    }

    /// Every node set that it names, with its place.
    pub fn node_sets(&self) -> Vec<(Pointer, &str)> {
        let at = Pointer::root().key("spec").key("template");
        let mut sets = vec![(at.key("skin"), self.skin.as_str())];
        for (member, names) in [("segments", &self.segments), ("skin_regions", &self.skin_regions)]
        {
            let place = at.key(member);
            sets.extend(names.iter().map(|(name, set)| (place.key(name), set.as_str())));
        }
        sets.extend(self.fixed.iter().map(|set| (at.key("fixed"), set.as_str())));
        let held = self.held.iter().enumerate();
        sets.extend(held.map(|(index, set)| (at.key("held").index(index), set.as_str())));
        let sliding = self.sliding.iter().enumerate();
        sets.extend(
            sliding.map(|(index, own)| {
                (at.key("sliding").index(index).key("nodes"), own.nodes.as_str())
            }),
        );
        sets
    }

    /// Whether a case of it needs checks of more than its node sets.
    pub fn has_tissue(&self) -> bool {
        self.regions.is_some()
            || self.materials.is_some()
            || !(self.muscles.is_empty() && self.sliding.is_empty())
    }

    /// The case of the template's mesh, everything by node sets.
    pub fn case(&self, volume: &str, units: LengthUnit) -> CaseDocument {
        let select = |set: &String| SelectionDocument::node_set(set);
        let mut case = CaseDocument::of_volume(volume, units);
        let segments = self.segments.iter();
        case.segments = segments
            .map(|(name, set)| SegmentDocument { name: name.clone(), nodes: select(set) })
            .collect();
        case.fixed = self.fixed.iter().chain(&self.held).map(select).collect();
        case.sliding = self.sliding.iter().map(TemplateSlidingDocument::of_case).collect();
        case.skin = Some(select(&self.skin));
        let parts = self.skin_regions.iter();
        case.skin_regions = parts.map(|(name, set)| (name.clone(), select(set))).collect();
        case.regions.clone_from(&self.regions);
        case.materials.clone_from(&self.materials);
        case.muscles.clone_from(&self.muscles);
        case.muscle_mixing = self.muscle_mixing;
        case
    }
}

impl TemplateSlidingDocument {
    fn of_case(&self) -> SlidingDocument {
        SlidingDocument {
            nodes: SelectionDocument::node_set(&self.nodes),
            normal: NormalDocument::default(),
            segment: self.segment.clone(),
        }
    }
}
