//! Alignment of the actual surface with the prediction in a comparison.

use std::collections::BTreeMap;

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer, Serialize};
use utoipa::ToSchema;

use super::place::PlaceDocument;
use super::reference::MeshReference;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_keys;
use crate::schema::wire::text_or_object::TextOrObject;
use crate::schema::{Matrix4x4, Triple};
use mechanics::plan::RigidMovement;

/// Whether the actual surface is moved rigidly onto the prediction before they are measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AlignDocument {
    #[serde(default)]
    pub method: AlignMethod,
    /// Of the actual surface onto the prediction: row-major, x' = R x + t in mm; required by `matrix`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub matrix4x4: Option<Matrix4x4>,
    /// At least three corresponding points of both surfaces; required by `landmarks`, and by `surfaces` if they are its
    /// `start`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, LandmarkDocument>,
    /// A surface registered with the prediction, such as bone before the operation; required by `surfaces`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fixed: Option<MeshReference>,
    /// Its counterpart, registered with the actual surface; required by `surfaces`. Its movement onto `fixed`
    /// is applied to the actual surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub moving: Option<MeshReference>,
    /// Initial position of `moving`; of `surfaces` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub start: Option<StartName>,
    /// Restricts an alignment by `icp` to this part of the prediction, one by `surfaces` to this part of `fixed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mask: Option<PlaceDocument>,
    /// Also reports the measures before the alignment.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub report_unaligned: bool,
}

/// An alignment by its name, or with its parameters.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[serde(untagged)]
pub enum AlignReference {
    Method(AlignMethod),
    Document(Box<AlignDocument>),
}

pub(in crate::schema) fn align<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<AlignDocument, D::Error> {
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
            matrix4x4: None,
            landmarks: BTreeMap::new(),
            fixed: None,
            moving: None,
            start: None,
            mask: None,
            report_unaligned: true,
        }
    }
}

/// A pair of corresponding points of both surfaces.
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
    /// By `matrix4x4`.
    Matrix,
    Landmarks,
    Icp,
    /// By the registration of `moving` onto `fixed` by iterative closest point.
    Surfaces,
}

/// The initial position of the iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum StartName {
    /// The surfaces unchanged; if their bounding boxes do not touch, with the centres of these aligned.
    #[default]
    None,
    /// Centres of the bounding boxes aligned.
    Boxes,
    /// Centres and principal axes aligned.
    Inertia,
    /// By `landmarks`.
    Landmarks,
}

impl AlignDocument {
    pub(in crate::schema) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        check_keys(&self.landmarks, &at.key("landmarks"), limits, faults);
        let (method, name) = (self.method, self.method.name());
        let by_surfaces = method == AlignMethod::Surfaces;
        let by_landmarks = method == AlignMethod::Landmarks
            || by_surfaces && self.start == Some(StartName::Landmarks);
        let members = [
            ("matrix4x4", self.matrix4x4.is_some(), method == AlignMethod::Matrix),
            ("fixed", self.fixed.is_some(), by_surfaces),
            ("moving", self.moving.is_some(), by_surfaces),
        ];
        for (member, is_given, is_needed) in members {
            if is_needed && !is_given {
                let detail = format!("`{member}` is needed where `method` is `{name}`");
                faults.add(&at.key(member), ErrorCode::MissingField, detail);
            }
        }
        let has_mask = by_surfaces || method == AlignMethod::Icp;
        let others = [
            ("landmarks", !self.landmarks.is_empty(), by_landmarks),
            ("start", self.start.is_some(), by_surfaces),
            ("mask", self.mask.is_some(), has_mask),
        ];
        for (member, is_given, is_read) in members.into_iter().chain(others) {
            if is_given && !is_read {
                let detail = format!("`{member}` is not read where `method` is `{name}`");
                faults.add(&at.key(member), ErrorCode::UnknownField, detail);
            }
        }
        let count = self.landmarks.len();
        if by_landmarks && count < 3 {
            let detail =
                format!("alignment by landmarks needs at least 3 of them, here are {count}");
            faults.add(&at.key("landmarks"), ErrorCode::AlignmentFailed, detail);
        }
        if let Some(mask) = &self.mask {
            mask.check(&at.key("mask"), faults);
        }
        if let Some(Err(error)) = self.matrix4x4.map(|m| RigidMovement::from_matrix4(&m.0)) {
            faults.add(&at.key("matrix4x4"), ErrorCode::PlanNotRigid, error.to_string());
        }
    }

    /// The surfaces of the alignment, with their places.
    pub fn surfaces_mut(&mut self, at: &Pointer) -> Vec<(Pointer, &mut String)> {
        let surfaces = [("fixed", &mut self.fixed), ("moving", &mut self.moving)];
        let named = surfaces.into_iter();
        named
            .filter_map(|(name, mesh)| Some((at.key(name).key("mesh"), &mut mesh.as_mut()?.mesh)))
            .collect()
    }
}

impl AlignMethod {
    pub fn name(self) -> &'static str {
        match self {
            AlignMethod::None => "none",
            AlignMethod::Matrix => "matrix",
            AlignMethod::Landmarks => "landmarks",
            AlignMethod::Icp => "icp",
            AlignMethod::Surfaces => "surfaces",
        }
    }
}
