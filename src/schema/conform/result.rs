//! The answer of a conformation: how far the template is left from the patient, and what its cells are worth.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::CaseDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::repair::RepairResultDocument;
use mechanics::conformation::FibreDifference;
use mechanics::mesh::quality::QualityReport;

/// A template on a patient, and the case that it is ready for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConformationDocument {
    /// From the points of the template's skin to the patient's; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin: Option<LeftDocument>,
    /// The same of bone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub bone: Option<LeftDocument>,
    /// Points of the template's skin that lie opposite the patient's, 0 to 1; the others follow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub share_with_partner: Option<f64>,
    /// How far each landmark is left from its place, in mm.
    pub landmarks_mm: BTreeMap<String, f64>,
    pub before_repair: CellsDocument,
    pub after_repair: CellsDocument,
    pub repair: RepairResultDocument,
    /// Muscles along lines, where the map has taken them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<MappedMuscleDocument>,
    /// A case of the mesh, ready to be stored and predicted on.
    pub case: CaseDocument,
    /// Of that case as it stands, before any segment moves; absent where only a plan can tell what holds it, or where the case is
    /// refused, which a warning tells then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub check: Option<CheckDocument>,
}

/// The lines of a muscle from the template to the patient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MappedMuscleDocument {
    pub name: String,
    pub lines: u64,
    /// Of all its lines together, on the template and on the patient.
    pub template_length_mm: f64,
    pub length_mm: f64,
    /// How many times as wide the tissue across the lines has become; `within_mm` of the case has grown by as much.
    pub widening: f64,
    /// How far the other map, by landmarks or the conformation, would have taken the lines from where they are; absent where
    /// landmarks give none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub beside_other_map: Option<MapDifferenceDocument>,
}

/// Two maps of the same lines; means by length, angles without sign.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MapDifferenceDocument {
    pub mean_deg: f64,
    pub max_deg: f64,
    pub mean_mm: f64,
    pub max_mm: f64,
}

/// Distances that are left, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftDocument {
    pub points: u64,
    pub mean_mm: f64,
    pub rms_mm: f64,
    pub p95_mm: f64,
    pub max_mm: f64,
}

/// Cells by the proof of their Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CellsDocument {
    pub cells: u64,
    /// A point with a Jacobian of zero or less is known.
    pub inverted: u64,
    /// Too close to zero to know the sign.
    pub undecided: u64,
    pub smallest_scaled_jacobian: f64,
}

impl LeftDocument {
    /// `None` without distances.
    pub fn of(distances: &[f64]) -> Option<LeftDocument> {
        let mut sorted = distances.to_vec();
        sorted.sort_by(f64::total_cmp);
        let max_mm = *sorted.last()?;
        let count = sorted.len() as f64;
        let squares: f64 = sorted.iter().map(|distance| distance * distance).sum();
        Some(LeftDocument {
            points: sorted.len() as u64,
            mean_mm: sorted.iter().sum::<f64>() / count,
            rms_mm: (squares / count).sqrt(),
            p95_mm: sorted[(0.95 * (count - 1.0)).round() as usize],
            max_mm,
        })
    }
}

impl From<FibreDifference> for MapDifferenceDocument {
    fn from(difference: FibreDifference) -> Self {
        MapDifferenceDocument {
            mean_deg: difference.mean_degrees,
            max_deg: difference.largest_degrees,
            mean_mm: difference.mean_mm,
            max_mm: difference.largest_mm,
        }
    }
}

impl From<&QualityReport> for CellsDocument {
    fn from(report: &QualityReport) -> Self {
        CellsDocument {
            cells: report.cells as u64,
            inverted: report.inverted as u64,
            undecided: report.undecided as u64,
            smallest_scaled_jacobian: report.smallest_scaled_jacobian,
        }
    }
}
