//! Surfaces between which tissue is meshed: a skin, and bone as one surface or in segments.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::case::document::BoneDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;

/// A skin and bone, with the defects of surfaces from scans: exactly one of `bone` and `bones`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfacesDocument {
    /// The skin: the id of an uploaded surface. Its flat ends are the ends of the scan.
    pub skin: String,
    /// All bone: the id of one surface, which the osteotomy cuts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub bone: Option<String>,
    /// A closed surface for each segment of bone that is cut already.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bones: Vec<BoneDocument>,
}

impl SurfacesDocument {
    /// The surfaces of bone, in their order, with their places below `at`.
    pub fn bones_at(&self, at: &Pointer) -> Vec<(Pointer, &String)> {
        let whole = self.bone.iter().map(|bone| (at.key("bone"), bone));
        let segments = self.bones.iter().enumerate();
        let segments =
            segments.map(|(number, bone)| (at.key("bones").index(number).key("mesh"), &bone.mesh));
        whole.chain(segments).collect()
    }

    /// Every mesh that it names, with its place below `at`.
    pub fn references_mut(&mut self, at: &Pointer) -> Vec<(Pointer, &mut String)> {
        let skin = std::iter::once((at.key("skin"), &mut self.skin));
        let whole = self.bone.iter_mut().map(|bone| (at.key("bone"), bone));
        let segments = self.bones.iter_mut().enumerate();
        let segments = segments
            .map(|(number, bone)| (at.key("bones").index(number).key("mesh"), &mut bone.mesh));
        skin.chain(whole).chain(segments).collect()
    }

    pub(super) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let given = usize::from(self.bone.is_some()) + usize::from(!self.bones.is_empty());
        faults.check_one_of(at, given, "`bone`, `bones`");
        let bones = at.key("bones");
        faults.check_length(&bones, self.bones.len(), limits.list_entries as usize);
        for (number, bone) in self.bones.iter().enumerate() {
            let longest = limits.name_characters as usize;
            faults.check_name(&bones.index(number).key("name"), bone.name.trim(), longest);
        }
    }
}
