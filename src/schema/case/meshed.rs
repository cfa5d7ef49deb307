//! A case whose mesh is made from a scan, and the body of `POST /v1/cases`: such a case or one with its mesh.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::acquisition::AcquisitionDocument;
use super::document::CaseDocument;
use super::hounsfield::HounsfieldDocument;
use super::material::{MaterialDocument, MaterialDocuments};
use crate::schema::code::ErrorCode;
use crate::schema::meshing::document::MeshingDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use crate::schema::wire::problem::Problem;
use crate::schema::wire::strict;

/// A patient's scene whose mesh is to be made from a scan. The meshing finds the volume, its boundary conditions,
/// skin, landmarks and bones; all else is stated here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshedCaseDocument {
    /// The version of this document: 1.
    #[serde(default = "one")]
    #[schema(default = 1, minimum = 1, maximum = 1)]
    pub schema: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// How the scan was taken; results repeat it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
    /// The job that makes the mesh, as posted. Its tags are given to the job, and the stored case has none of them.
    pub meshing: MeshingDocument,
    /// By region name; `*` is for every region without an entry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// Materials by image values; they override those of the regions. The image may be the scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub hounsfield: Option<HounsfieldDocument>,
    /// Permits plans that move all bones alike while nothing is fixed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schema(default = false)]
    pub allow_unfixed: bool,
}

fn one() -> u32 {
    1
}

impl MeshedCaseDocument {
    /// Every image that the document refers to, with its place.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let mut found = self.meshing.mesh_references_mut(&root.key("meshing"));
        if let Some(hounsfield) = &mut self.hounsfield {
            found.push((root.key("hounsfield").key("image"), &mut hounsfield.image));
        }
        found
    }

    /// Checks that need no mesh and no scan; pointers start at the document.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root();
        if self.schema != one() {
            let detail = format!("schema {} is not known, only 1 is", self.schema);
            faults.add(&at.key("schema"), ErrorCode::OutOfRange, detail);
        }
        if let Some(name) = &self.name {
            faults.check_name(&at.key("name"), name, limits.name_characters as usize);
        }
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        if let Some(acquisition) = &self.acquisition {
            acquisition.check(&at.key("acquisition"), limits, faults);
        }
    }

    /// The case that a meshing has made, with the statements here.
    pub fn complete(&self, mut found: CaseDocument) -> CaseDocument {
        found.name.clone_from(&self.name);
        found.tags.clone_from(&self.tags);
        found.acquisition.clone_from(&self.acquisition);
        found.materials.clone_from(&self.materials);
        found.hounsfield.clone_from(&self.hounsfield);
        found.allow_unfixed = self.allow_unfixed;
        found
    }
}

/// A case with the id of its volume mesh, or one whose mesh is to be made: distinguished by `volume` or `meshing`.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum CaseBody {
    Whole(Box<CaseDocument>),
    ToMesh(Box<MeshedCaseDocument>),
}

impl CaseBody {
    /// The body of `POST /v1/cases`.
    pub fn parse(bytes: &[u8], limits: &Limits) -> Result<CaseBody, Problem> {
        let value = strict::parse_value(bytes, limits)?;
        match is_to_mesh(&value) {
            true => strict::from_value(value).map(CaseBody::ToMesh),
            false => strict::from_value(value).map(CaseBody::Whole),
        }
    }

    /// The same as stored.
    pub fn stored(text: &str) -> serde_json::Result<CaseBody> {
        let value: Value = serde_json::from_str(text)?;
        match is_to_mesh(&value) {
            true => serde_json::from_value(value).map(CaseBody::ToMesh),
            false => serde_json::from_value(value).map(CaseBody::Whole),
        }
    }

    pub fn tags(&self) -> &[String] {
        match self {
            CaseBody::Whole(case) => &case.tags,
            CaseBody::ToMesh(case) => &case.tags,
        }
    }

    /// Takes the tags of its meshing out of it: they are those of the job, and change with it.
    pub fn take_tags_of_job(&mut self) -> Vec<String> {
        match self {
            CaseBody::Whole(_) => Vec::new(),
            CaseBody::ToMesh(case) => std::mem::take(&mut case.meshing.tags),
        }
    }

    /// Every mesh and image that the document refers to, with its place.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        match self {
            CaseBody::Whole(case) => case.mesh_references_mut(),
            CaseBody::ToMesh(case) => case.mesh_references_mut(),
        }
    }

    /// Their ids, each once, the volume first.
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

fn is_to_mesh(value: &Value) -> bool {
    value.get("meshing").is_some()
}
