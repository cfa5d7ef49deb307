//! A scene of a study, in a report.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::warning::WarningDocument;

/// A scene at level 0, and its reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudySceneDocument {
    pub name: String,
    pub nodes: u64,
    pub cells: u64,
    /// Edge of a cube with the volume of six tetrahedra, two wedges or one hexahedron in the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cell_mm: Option<f64>,
    pub skin_nodes: u64,
    /// Of a case: the SHA-256 of each of its plans as stated, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(required = false)]
    pub plans: BTreeMap<String, String>,
    /// Of a case: the SHA-256 of its document, contents of meshes instead of their ids, without names and tags.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub case: Option<String>,
    pub truth: String,
    /// The error of the reference itself, mean and p95 over the skin, by extrapolation; absent if it is a formula or
    /// unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth_error_mm: Option<TruthErrorDocument>,
    /// Of a scan: its distance from the skin before the movement, measured like rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unmoved_mm: Option<f64>,
    /// Of a scan: root mean square distance left by its registration, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub noise_mm: Option<f64>,
    /// Objections to a scan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub warnings: Vec<WarningDocument>,
    /// Time of the reference; not part of any row.
    pub truth_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TruthErrorDocument {
    pub mean: f64,
    pub p95: f64,
}
