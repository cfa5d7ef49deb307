//! Case document: the meshes of a patient, their anatomical meaning, and their boundary conditions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::acquisition::AcquisitionDocument;
use super::bone_landmark::BoneLandmarkOfCaseDocument;
use super::hounsfield::HounsfieldDocument;
use super::material::{MaterialDocument, MaterialDocuments};
use super::muscle::MuscleDocument;
use super::muscle_mixing::MuscleMixingDocument;
use super::norm::{NormDocument, NormDocuments};
use super::selection::SelectionDocument;
use crate::schema::Triple;
use crate::schema::repair::RepairDocument;
use crate::schema::wire::fault::Pointer;
use mechanics::mesh::Frame;

pub use super::meshes::{CaseMeshes, NamedMesh};

/// A patient's scene. Lengths in the document are mm; those of the meshes are in `units`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseDocument {
    /// The version of this document: 1.
    #[serde(default = "one")]
    #[schema(default = 1, minimum = 1, maximum = 1)]
    pub schema: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// The unit of length of every mesh of the case.
    pub units: LengthUnit,
    #[serde(default)]
    pub frame: FrameName,
    /// The volume mesh: its id.
    pub volume: String,
    /// How the scan of the meshes was taken; results repeat it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bones: Vec<BoneDocument>,
    /// Named points in mm; each moves with the closest point of the surface.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, Triple>,
    /// Named points of bone, for cephalometric measures; each moves with its segment.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bone_landmarks: BTreeMap<String, BoneLandmarkOfCaseDocument>,
    /// Norms of cephalometric measures, by their names; they replace built-in ones.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(value_type = BTreeMap<String, NormDocument>)]
    pub norms: NormDocuments,
    /// Absent: one region named `tissue`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub regions: Option<RegionsDocument>,
    /// Absent: all boundary faces without a joined, fixed or sliding node.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin: Option<SelectionDocument>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub skin_regions: BTreeMap<String, SelectionDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<SegmentDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed: Vec<SelectionDocument>,
    /// Permits plans that move all bones alike while nothing is fixed, so that all tissue moves rigidly.
    #[serde(default, skip_serializing_if = "is_false")]
    #[schema(default = false)]
    pub allow_unfixed: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sliding: Vec<SlidingDocument>,
    /// By region name; `*` is for every region without an entry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// Muscles that plans may activate.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<MuscleDocument>,
    /// How muscles with a `material` are mixed into cells that they fill in part. Absent: `voigt`, 64 samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub muscle_mixing: Option<MuscleMixingDocument>,
    /// Materials by image values; they override those of the regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub hounsfield: Option<HounsfieldDocument>,
    /// Moves nodes within bounds until every cell of the volume is proven valid at every point, or reported. Absent: the mesh is
    /// unchanged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub repair: Option<RepairDocument>,
}

fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_false(value: &bool) -> bool {
    !value
}

/// The unit of length of mesh files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    #[default]
    Mm,
    M,
    Um,
}

impl LengthUnit {
    /// Length of the unit in mm.
    pub fn in_mm(self) -> f64 {
        match self {
            LengthUnit::Mm => 1.0,
            LengthUnit::M => 1000.0,
            LengthUnit::Um => 0.001,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            LengthUnit::Mm => "mm",
            LengthUnit::M => "m",
            LengthUnit::Um => "um",
        }
    }
}

/// Left, posterior, superior; or right, anterior, superior.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum FrameName {
    #[serde(rename = "LPS")]
    Lps,
    #[serde(rename = "RAS")]
    Ras,
    #[default]
    #[serde(rename = "unspecified")]
    Unspecified,
}

impl From<FrameName> for Frame {
    fn from(name: FrameName) -> Frame {
        match name {
            FrameName::Lps => Frame::Lps,
            FrameName::Ras => Frame::Ras,
            FrameName::Unspecified => Frame::Unspecified,
        }
    }
}

impl From<Frame> for FrameName {
    fn from(frame: Frame) -> FrameName {
        match frame {
            Frame::Lps => FrameName::Lps,
            Frame::Ras => FrameName::Ras,
            Frame::Unspecified => FrameName::Unspecified,
        }
    }
}

/// A bone surface; it moves with the segment of its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoneDocument {
    pub name: String,
    /// The surface mesh: its id.
    pub mesh: String,
}

/// The integer cell array that divides the mesh into regions, and names of its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionsDocument {
    /// At most `label_values` of the limits distinct values.
    pub array: String,
    /// A value without a name is named by its number.
    #[serde(default)]
    pub names: BTreeMap<String, String>,
}

/// The nodes that move with a bone segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SegmentDocument {
    pub name: String,
    pub nodes: SelectionDocument,
}

/// Nodes constrained along a normal, free tangentially.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SlidingDocument {
    pub nodes: SelectionDocument,
    #[serde(default)]
    pub normal: NormalDocument,
    /// The segment that moves the wall, such as the jaw its teeth: the nodes follow the wall along
    /// its normal and stay free tangentially. Absent: the wall stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
}

/// The direction in which sliding nodes are constrained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum NormalDocument {
    Word(NormalWord),
    Direction(Triple),
}

impl Default for NormalDocument {
    fn default() -> Self {
        NormalDocument::Word(NormalWord::Surface)
    }
}

/// The normals of the selected boundary faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum NormalWord {
    Surface,
}

impl CaseDocument {
    /// A case of a volume mesh only.
    pub fn of_volume(volume: &str, units: LengthUnit) -> Self {
        CaseDocument {
            schema: one(),
            name: None,
            tags: Vec::new(),
            units,
            frame: FrameName::Unspecified,
            volume: volume.to_owned(),
            acquisition: None,
            bones: Vec::new(),
            landmarks: BTreeMap::new(),
            bone_landmarks: BTreeMap::new(),
            norms: BTreeMap::new(),
            regions: None,
            skin: None,
            skin_regions: BTreeMap::new(),
            segments: Vec::new(),
            fixed: Vec::new(),
            allow_unfixed: false,
            sliding: Vec::new(),
            materials: None,
            muscles: Vec::new(),
            muscle_mixing: None,
            hounsfield: None,
            repair: None,
        }
    }

    /// Every mesh and image the case refers to, with its place: the volume, the bones, the image, the surfaces of muscles, and
    /// those of selections.
    /// A selection may also name a bone; the names of bones are omitted.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let bone_names: Vec<String> = self.bones.iter().map(|bone| bone.name.clone()).collect();
        let mut found = vec![(root.key("volume"), &mut self.volume)];
        for (index, bone) in self.bones.iter_mut().enumerate() {
            found.push((root.key("bones").index(index).key("mesh"), &mut bone.mesh));
        }
        if let Some(hounsfield) = &mut self.hounsfield {
            found.push((root.key("hounsfield").key("image"), &mut hounsfield.image));
        }
        for (index, muscle) in self.muscles.iter_mut().enumerate() {
            let at = root.key("muscles").index(index).key("surface");
            found.extend(muscle.surface.as_mut().map(|surface| (at, surface)));
        }
        let mut surfaces = Vec::new();
        if let Some(skin) = &mut self.skin {
            skin.surfaces_mut(&root.key("skin"), &mut surfaces);
        }
        for (name, region) in &mut self.skin_regions {
            region.surfaces_mut(&root.key("skin_regions").key(name), &mut surfaces);
        }
        for (index, segment) in self.segments.iter_mut().enumerate() {
            let at = root.key("segments").index(index).key("nodes");
            segment.nodes.surfaces_mut(&at, &mut surfaces);
        }
        for (index, fixed) in self.fixed.iter_mut().enumerate() {
            fixed.surfaces_mut(&root.key("fixed").index(index), &mut surfaces);
        }
        for (index, sliding) in self.sliding.iter_mut().enumerate() {
            let at = root.key("sliding").index(index).key("nodes");
            sliding.nodes.surfaces_mut(&at, &mut surfaces);
        }
        surfaces.retain(|(_, surface)| !bone_names.contains(surface));
        found.extend(surfaces);
        found
    }

    /// The ids of all meshes and images the case refers to, each once, the volume first.
    pub fn mesh_ids(&self) -> Vec<String> {
        let mut copy = self.clone();
        let mut ids: Vec<String> = Vec::new();
        for (_, id) in copy.mesh_references_mut() {
            if !ids.contains(id) {
                ids.push(id.clone());
            }
        }
        ids
    }
}
