//! The spec of a comparison: two surfaces, their alignment, and the measured regions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

pub use super::align::{AlignDocument, AlignMethod, AlignReference, LandmarkDocument, StartName};
pub use super::place::{ComparedRegionDocument, PlaceDocument};
pub use super::reference::{MeshReference, SurfaceReference};

use super::align::align;
use crate::schema::case::acquisition::AcquisitionDocument;
use crate::schema::code::ErrorCode;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::{check_keys, check_tags};

/// `compare`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CompareKind {
    #[default]
    Compare,
}

/// A comparison of a predicted with an actual surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CompareDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: CompareKind,
    pub prediction: SurfaceReference,
    pub actual: MeshReference,
    #[serde(default, deserialize_with = "align")]
    #[schema(value_type = AlignReference)]
    pub align: AlignDocument,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions: BTreeMap<String, ComparedRegionDocument>,
    #[serde(default = "default_samples_per_mm2")]
    #[schema(default = 1.0, exclusive_minimum = 0.0, maximum = 100.0)]
    pub samples_per_mm2: f64,
    #[serde(default)]
    pub node_wise: NodeWise,
    /// Corresponding points of both surfaces, those of the actual one before alignment. Their distances are reported; four
    /// or more that are not coplanar also give distances by thin-plate spline and closest point.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, LandmarkDocument>,
    /// Ascending edges of the bins of a histogram of distances, in mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histogram_edges_mm: Vec<f64>,
    /// How the actual surface was taken; the result repeats it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
    /// The signed distance at both ends of the colour scale, in mm: also writes `skin.ply` and `skin.glb` with it, and is the range
    /// of the report. Absent: `skin.vtp` only, and 2 mm in the report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.01, maximum = 100.0)]
    pub range_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// A comparison within a prediction: the predicted skin with another surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CompareToDocument {
    #[serde(default)]
    pub kind: CompareKind,
    pub actual: MeshReference,
    #[serde(default, deserialize_with = "align")]
    #[schema(value_type = AlignReference)]
    pub align: AlignDocument,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions: BTreeMap<String, ComparedRegionDocument>,
    #[serde(default = "default_samples_per_mm2")]
    #[schema(default = 1.0, exclusive_minimum = 0.0, maximum = 100.0)]
    pub samples_per_mm2: f64,
    #[serde(default)]
    pub node_wise: NodeWise,
    /// Corresponding points of both surfaces, those of the actual one before alignment. Their distances are reported; four
    /// or more that are not coplanar also give distances by thin-plate spline and closest point.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, LandmarkDocument>,
    /// Ascending edges of the bins of a histogram of distances, in mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histogram_edges_mm: Vec<f64>,
    /// How the actual surface was taken; the result repeats it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
}

fn default_samples_per_mm2() -> f64 {
    1.0
}

/// Whether the distance between points with the same index is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum NodeWise {
    /// If `node_id` arrays or the triangles of both agree.
    #[default]
    Auto,
    On,
    Off,
}

impl CompareToDocument {
    /// With another surface without alignment, and all else by default.
    pub fn of(actual: MeshReference) -> Self {
        CompareToDocument {
            kind: CompareKind::Compare,
            actual,
            align: AlignDocument::default(),
            regions: BTreeMap::new(),
            samples_per_mm2: default_samples_per_mm2(),
            node_wise: NodeWise::Auto,
            landmarks: BTreeMap::new(),
            histogram_edges_mm: Vec::new(),
            acquisition: None,
        }
    }

    /// Adds its faults.
    pub fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        self.align.check(&at.key("align"), limits, faults);
        let place = at.key("regions");
        check_keys(&self.regions, &place, limits, faults);
        for (name, region) in &self.regions {
            region.check(&place.key(name), faults);
        }
        let density = 1e-4..=limits.samples_per_mm2;
        let place = at.key("samples_per_mm2");
        faults.check_range(&place, self.samples_per_mm2, density, "per mm2");
        check_keys(&self.landmarks, &at.key("landmarks"), limits, faults);
        if let Some(acquisition) = &self.acquisition {
            acquisition.check(&at.key("acquisition"), limits, faults);
        }
        check_edges(&self.histogram_edges_mm, &at.key("histogram_edges_mm"), limits, faults);
    }

    /// Every mesh that it names, with its place under `at`.
    pub fn mesh_references_mut(&mut self, at: &Pointer) -> Vec<(Pointer, &mut String)> {
        let mut found = vec![(at.key("actual").key("mesh"), &mut self.actual.mesh)];
        found.extend(self.align.surfaces_mut(&at.key("align")));
        found
    }

    /// Their ids.
    pub fn mesh_ids(&self) -> Vec<String> {
        let mut copy = self.clone();
        let named = copy.mesh_references_mut(&Pointer::root()).into_iter();
        named.map(|(_, id)| id.clone()).collect()
    }

    /// Everything that determines the numbers, for the hash of a job.
    pub fn content(&self) -> Value {
        canonical::to_value(self)
    }
}

impl CompareDocument {
    /// Adds its faults; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        let reference = &self.prediction;
        let given = usize::from(reference.job.is_some()) + usize::from(reference.mesh.is_some());
        faults.check_one_of(&at.key("prediction"), given, "`job`, `mesh`");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        if let Some(range) = self.range_mm {
            faults.check_range(&at.key("range_mm"), range, 0.01..=100.0, "mm");
        }
        self.to_compare_to().check(&at, limits, faults);
    }

    /// The part that does not depend on the source of the prediction.
    pub fn to_compare_to(&self) -> CompareToDocument {
        CompareToDocument {
            kind: self.kind,
            actual: self.actual.clone(),
            align: self.align.clone(),
            regions: self.regions.clone(),
            samples_per_mm2: self.samples_per_mm2,
            node_wise: self.node_wise,
            landmarks: self.landmarks.clone(),
            histogram_edges_mm: self.histogram_edges_mm.clone(),
            acquisition: self.acquisition.clone(),
        }
    }

    /// Every mesh that it names, with its place.
    pub fn mesh_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let mut found = vec![(root.key("actual").key("mesh"), &mut self.actual.mesh)];
        let prediction = self.prediction.mesh.as_mut();
        found.extend(prediction.map(|mesh| (root.key("prediction").key("mesh"), mesh)));
        found.extend(self.align.surfaces_mut(&root.key("align")));
        found
    }
}

fn check_edges(edges: &[f64], at: &Pointer, limits: &Limits, faults: &mut Faults) {
    faults.check_length(at, edges.len(), limits.list_entries as usize);
    for (index, edge) in edges.iter().enumerate() {
        faults.check_range(&at.index(index), *edge, -1e3..=1e3, "mm");
        if index > 0 && *edge <= edges[index - 1] {
            let detail = format!("{edge} mm is not above the edge before it");
            faults.add(&at.index(index), ErrorCode::OutOfRange, detail);
        }
    }
}
