//! The spec of a comparison: two surfaces, whether they are aligned first, and where they are measured.

use std::collections::BTreeMap;

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use crate::schema::wire::text_or_object::TextOrObject;
use crate::schema::{CornerPair, Sphere, Triple};

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
    pub regions: BTreeMap<String, PlaceDocument>,
    #[serde(default = "usual_density")]
    #[schema(default = 1.0, exclusive_minimum = 0.0, maximum = 100.0)]
    pub samples_per_mm2: f64,
    #[serde(default)]
    pub node_wise: NodeWise,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// A comparison within a prediction: that of the predicted skin with another surface.
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
    pub regions: BTreeMap<String, PlaceDocument>,
    #[serde(default = "usual_density")]
    #[schema(default = 1.0, exclusive_minimum = 0.0, maximum = 100.0)]
    pub samples_per_mm2: f64,
    #[serde(default)]
    pub node_wise: NodeWise,
}

fn usual_density() -> f64 {
    1.0
}

/// A surface: exactly one of the predicted skin of a `job` and a `mesh`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceReference {
    /// The id of a successful prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// The id of a mesh; of a volume mesh the boundary is compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh: Option<String>,
}

/// A mesh by its id; of a volume mesh the boundary is compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshReference {
    pub mesh: String,
}

/// Whether the actual surface is moved rigidly onto the prediction before they are measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AlignDocument {
    #[serde(default)]
    pub method: AlignMethod,
    /// At least three places that both surfaces have; required by `landmarks`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, LandmarkDocument>,
    /// Only the part of the prediction in it decides an alignment by `icp`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mask: Option<PlaceDocument>,
    /// Reports the measures before the alignment as well.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub report_unaligned: bool,
}

/// A way to align by its name, or with what it has to be told. Only described here.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[serde(untagged)]
pub enum AlignReference {
    Method(AlignMethod),
    Document(AlignDocument),
}

fn align<'de, D: Deserializer<'de>>(deserializer: D) -> Result<AlignDocument, D::Error> {
    Ok(match TextOrObject::deserialize(deserializer)? {
        TextOrObject::Text(name) => {
            let method = AlignMethod::deserialize(name.into_deserializer())?;
            AlignDocument { method, ..AlignDocument::default() }
        }
        TextOrObject::Object(document) => document,
    })
}

fn yes() -> bool {
    true
}

impl Default for AlignDocument {
    fn default() -> Self {
        AlignDocument {
            method: AlignMethod::None,
            landmarks: BTreeMap::new(),
            mask: None,
            report_unaligned: true,
        }
    }
}

/// The same place on both surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LandmarkDocument {
    pub prediction_mm: Triple,
    pub actual_mm: Triple,
}

/// How surfaces are aligned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum AlignMethod {
    #[default]
    None,
    Landmarks,
    Icp,
}

/// A part of space: exactly one of a sphere and a box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceDocument {
    /// Centre and radius: x, y, z, r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sphere_mm: Option<Sphere>,
    /// Lowest and highest corner: x0, y0, z0, x1, y1, z1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub box_mm: Option<CornerPair>,
}

/// Whether the distance between points of the same number is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum NodeWise {
    /// Where `node_id` arrays or the triangles of both agree.
    #[default]
    Auto,
    On,
    Off,
}

impl CompareToDocument {
    /// Adds what is wrong with it.
    pub fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        self.align.check(&at.key("align"), limits, faults);
        let place = at.key("regions");
        faults.check_length(&place, self.regions.len(), limits.map_entries as usize);
        for (name, region) in &self.regions {
            faults.check_name(&place.key(name), name, limits.name_characters as usize);
            region.check(&place.key(name), faults);
        }
        let density = 1e-4..=limits.samples_per_mm2;
        let place = at.key("samples_per_mm2");
        faults.check_range(&place, self.samples_per_mm2, density, "per mm2");
    }

    /// What decides the numbers, for the hash of a job.
    pub fn content(&self) -> Value {
        canonical::to_value(self)
    }
}

impl CompareDocument {
    /// Adds what is wrong with it; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        let reference = &self.prediction;
        let given = usize::from(reference.job.is_some()) + usize::from(reference.mesh.is_some());
        faults.check_one_of(&at.key("prediction"), given, "`job`, `mesh`");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        self.to_compare_to().check(&at, limits, faults);
    }

    /// The part that does not depend on where the prediction comes from.
    pub fn to_compare_to(&self) -> CompareToDocument {
        CompareToDocument {
            kind: self.kind,
            actual: self.actual.clone(),
            align: self.align.clone(),
            regions: self.regions.clone(),
            samples_per_mm2: self.samples_per_mm2,
            node_wise: self.node_wise,
        }
    }
}

impl AlignDocument {
    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let place = at.key("landmarks");
        let count = self.landmarks.len();
        faults.check_length(&place, count, limits.map_entries as usize);
        for name in self.landmarks.keys() {
            faults.check_name(&place.key(name), name, limits.name_characters as usize);
        }
        let wanted = self.method == AlignMethod::Landmarks;
        if wanted && count < 3 {
            let detail =
                format!("alignment by landmarks needs at least 3 of them, here are {count}");
            faults.add(&place, ErrorCode::AlignmentFailed, detail);
        }
        if !wanted && count > 0 {
            let detail = "landmarks are read where `method` is `landmarks`";
            faults.add(&place, ErrorCode::UnknownField, detail);
        }
        if let Some(mask) = &self.mask {
            mask.check(&at.key("mask"), faults);
            if self.method != AlignMethod::Icp {
                let detail = "a mask is read where `method` is `icp`";
                faults.add(&at.key("mask"), ErrorCode::UnknownField, detail);
            }
        }
    }
}

impl PlaceDocument {
    fn check(&self, at: &Pointer, faults: &mut Faults) {
        let given = usize::from(self.sphere_mm.is_some()) + usize::from(self.box_mm.is_some());
        if !faults.check_one_of(at, given, "`sphere_mm`, `box_mm`") {
            return;
        }
        if let Some(Sphere([.., radius])) = self.sphere_mm {
            faults.check_range(&at.key("sphere_mm").index(3), radius, 1e-6..=1e6, "mm");
        }
        if let Some(CornerPair([x0, y0, z0, x1, y1, z1])) = self.box_mm
            && !(x0 < x1 && y0 < y1 && z0 < z1)
        {
            let detail = "each coordinate of the lowest corner is below that of the highest";
            faults.add(&at.key("box_mm"), ErrorCode::OutOfRange, detail);
        }
    }
}
