//! Report of an uploaded mesh or image: its content and warnings.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{CornerPair, Triple};
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::wire::warning::WarningDocument;
use mechanics::mesh::Frame;

/// The response of `POST /v1/meshes` and `GET /v1/meshes/{id}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshDocument {
    pub id: String,
    /// Of the uploaded bytes, in hexadecimal.
    pub sha256: String,
    pub bytes: u64,
    /// As detected from the bytes, e.g. `vtu`, `stl`, `gmsh`, `nrrd`, `dicom`.
    pub format: String,
    /// RFC 3339, UTC: when it was stored, or uploaded again by itself, from which its retention counts.
    pub created: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub role: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub units: Option<LengthUnit>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub frame: Option<FrameName>,
    pub report: MeshReport,
}

impl MeshDocument {
    /// What it is to a job: the hash of its bytes, with the frame and the unit that were stated beside them.
    pub fn identity(&self) -> String {
        let frame = self.frame.filter(|_| self.report.space.is_none()).map(Frame::from);
        let frame = frame.and_then(Frame::known).map(Frame::name);
        let units = self.units.filter(|units| *units != LengthUnit::Mm).map(LengthUnit::name);
        let stated = [frame, units].into_iter().flatten();
        stated.fold(self.sha256.clone(), |identity, own| format!("{identity} {own}"))
    }

    /// What it is to a case.
    pub fn content_in_case(&self) -> String {
        content_in_case(self.report.image.is_some(), &self.sha256, &self.identity())
    }
}

/// What a mesh is to a case, whose meshes are in the case's frame and unit or refused: an image is turned from its own frame.
pub fn content_in_case(is_image: bool, sha256: &str, identity: &str) -> String {
    if is_image { identity.to_owned() } else { sha256.to_owned() }
}

/// Content of a mesh file. Lengths are in the units of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshReport {
    pub kind: MeshKind,
    pub nodes: u64,
    /// Cells of a volume by shape: `tet4`, `hex8`, `wedge6`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cells: BTreeMap<String, u64>,
    /// Triangles of a surface, or of the boundary of a volume.
    pub triangles: u64,
    /// Lowest and highest corner.
    pub bounding_box: CornerPair,
    pub diagonal: f64,
    /// The frame in a `SPACE=` mark of the file, or in the `space` of an image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub space: Option<FrameName>,
    /// Named sets with their number of nodes.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub node_sets: BTreeMap<String, u64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cell_sets: BTreeMap<String, u64>,
    /// Integer arrays with their distinct values, at most `label_values` of the limits.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub node_labels: BTreeMap<String, Vec<i64>>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cell_labels: BTreeMap<String, Vec<i64>>,
    /// Arrays of vectors, for displacements prescribed by array.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub node_vectors: Vec<String>,
    /// Arrays of vectors of cells, for fibre directions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cell_vectors: Vec<String>,
    /// Ignored arrays of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ignored_arrays: Vec<String>,
    /// Why they are ignored, in the same order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ignored_because: Vec<IgnoredArrayDocument>,
    /// Of volumes: the smallest scaled Jacobian of a cell; 1 is perfect, below 0 is inverted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub min_quality: Option<f64>,
    /// Of images only; their bounding box and its diagonal are mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub image: Option<ImageReport>,
    pub warnings: Vec<WarningDocument>,
    /// Of a volume made by a meshing: its warnings on the scan or the surfaces. Every job on the mesh repeats them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub meshing: Vec<WarningDocument>,
}

/// An ignored array of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct IgnoredArrayDocument {
    pub name: String,
    /// `point` or `cell`.
    pub of: String,
    /// E.g. `holds 10432 distinct values, at most 4096 make regions`.
    pub why: String,
}

/// The kind of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeshKind {
    Volume,
    Surface,
    /// Voxels.
    Image,
}

/// The voxels of an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImageReport {
    /// Voxels along each axis.
    pub size: Vec<u64>,
    /// Their spacing along each axis.
    pub spacing_mm: Triple,
    /// The centre of the first voxel.
    pub origin_mm: Triple,
    /// The direction of each axis.
    pub directions: Vec<Triple>,
    /// The lowest value.
    pub lowest_hu: f64,
    pub highest_hu: f64,
    /// Type of the stored values: `int16` or `float32`.
    pub kept_as: String,
}
