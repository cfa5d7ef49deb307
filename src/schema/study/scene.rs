//! A scene of a study, as a report has it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::warning::WarningDocument;

/// A scene at level 0, and what is held for true in it.
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
    /// Of a case: the SHA-256 of each of its plans as it was stated, by its name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(required = false)]
    pub plans: BTreeMap<String, String>,
    /// Of a case: the SHA-256 of what it states, contents of meshes in place of their ids, names and tags left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub case: Option<String>,
    pub truth: String,
    /// What the truth itself is off by, mean and p95 over the skin, by extrapolation; absent where it is a formula or
    /// not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth_error_mm: Option<TruthErrorDocument>,
    /// Of a scan: how far the skin at rest is from it, measured as rows are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unmoved_mm: Option<f64>,
    /// Of a scan: root of the mean squared distance that its registration left, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub noise_mm: Option<f64>,
    /// What speaks against a scan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub warnings: Vec<WarningDocument>,
    /// Making the truth; part of no row.
    pub truth_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TruthErrorDocument {
    pub mean: f64,
    pub p95: f64,
}
