//! Osteotomies: the cuts through the bone of a scan, and the resulting segments.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::{TriangleCorners, Triple};

/// Cuts through the bone of a scan and the segments on their sides; coordinates in the frame of the plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OsteotomyDocument {
    /// Planar cuts; each is named by a segment.
    #[serde(default)]
    pub cuts: Vec<CutDocument>,
    /// Cuts along lines; each is named by a segment, which has a seed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub polylines: Vec<PolylineCutDocument>,
    /// Pieces of bone; the plan moves them by the same names, and those that it does not name stay.
    pub segments: Vec<CutSegmentDocument>,
    /// Structures at risk, such as the inferior alveolar nerve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub risks: Vec<RiskDocument>,
    /// Nodes on bone within this distance of bone that moves differently are free, 0 to 30 mm. Default: 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub free_band_mm: Option<f64>,
}

/// A planar cut: the whole plane, a disc, or a polygon.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CutDocument {
    pub name: String,
    pub point_mm: Triple,
    /// From below to above; of any length.
    pub normal: Triple,
    /// Cuts only a disc of this radius around the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub radius_mm: Option<f64>,
    /// Cuts only a polygon: its corners in order, at least three, projected to the plane along the normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub corners_mm: Option<Vec<Triple>>,
    /// The width of the saw, 0 to 10 mm. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub kerf_mm: Option<f64>,
}

/// A cut along a polyline into bone: a chain of parallelograms, such as a stepped cut.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PolylineCutDocument {
    /// Its name in segments, for all its pieces.
    pub name: String,
    /// Two or more points in order, where the saw enters the bone.
    #[schema(min_items = 2)]
    pub polyline_mm: Vec<Triple>,
    /// Into the bone; of any length, parallel to no piece of the line. Above a piece is the side of (its direction) x `direction`.
    pub direction: Triple,
    /// Depth of the cut along `direction`, 0.1 to 300 mm.
    #[schema(minimum = 0.1, maximum = 300.0)]
    pub depth_mm: f64,
    /// The width of the saw, 0 to 10 mm. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub kerf_mm: Option<f64>,
}

/// A structure at risk, as a line of points or as a surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RiskDocument {
    pub name: String,
    /// Two or more, in order along the line; with `triangles` the corners of a surface.
    #[schema(min_items = 2)]
    pub points_mm: Vec<Triple>,
    /// Triangles of a surface, each three of the points, counted from 0. Absent: a line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub triangles: Vec<TriangleCorners>,
    /// Its radius around its line or surface, 0 to 20 mm. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 20.0)]
    pub radius_mm: Option<f64>,
    /// Cuts nearer than this have a warning, 0 to 50 mm.
    #[schema(minimum = 0.0, maximum = 50.0)]
    pub clearance_mm: f64,
}

/// The bone on given sides of cuts that is connected with its seeds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CutSegmentDocument {
    pub name: String,
    /// Cuts that the segment is below.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub below: Vec<String>,
    /// Cuts that the segment is above, on the side of their normals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub above: Vec<String>,
    /// Points in its bone, or at most 10 mm from it. Default: the largest piece on its sides of the cuts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seeds_mm: Vec<Triple>,
}
