//! The result of a conformation: the remaining distance of the template from the patient, and the validity of its cells.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::CaseDocument;
use crate::schema::case::muscle::MuscleDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::repair::RepairResultDocument;
use mechanics::conformation::FibreDifference;
use mechanics::mesh::quality::QualityReport;

/// A template on a patient, and a case of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConformationDocument {
    /// From the points of the template's skin to the patient's; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin: Option<LeftDocument>,
    /// The same for bone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub bone: Option<LeftDocument>,
    /// Share of the points of the template's skin that face the patient's, 0 to 1; the others follow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub share_with_partner: Option<f64>,
    /// The remaining distance of each landmark from its target, in mm.
    pub landmarks_mm: BTreeMap<String, f64>,
    pub before_repair: CellsDocument,
    pub after_repair: CellsDocument,
    pub repair: RepairResultDocument,
    /// Muscles along lines, mapped to the patient.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<MappedMuscleDocument>,
    /// A case of the mesh, ready to be stored and predicted on.
    pub case: CaseDocument,
    /// The check of that case before any segment moves; absent if its constraints depend on a plan, or if the case is
    /// refused, with a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub check: Option<CheckDocument>,
}

/// A muscle from the template to the patient: its lines or its surface, or both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MappedMuscleDocument {
    pub name: String,
    /// 0 of a muscle with a surface and fibres that have no lines.
    pub lines: u64,
    /// Of all its lines together, on the template and on the patient.
    pub template_length_mm: f64,
    pub length_mm: f64,
    /// Stretch of the tissue across the lines, 1 without any; `within_mm` of the case is scaled by it.
    pub widening: f64,
    /// Enclosed by its surface or box on the template.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub template_volume_ml: Option<f64>,
    /// Enclosed by its surface on the patient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub volume_ml: Option<f64>,
    /// Distance of the lines from those of the other map, by landmarks or the conformation; absent if
    /// landmarks define none.
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

/// Remaining distances, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftDocument {
    pub points: u64,
    pub mean_mm: f64,
    pub rms_mm: f64,
    pub p95_mm: f64,
    pub max_mm: f64,
}

/// Cells by the proven sign of their Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CellsDocument {
    pub cells: u64,
    /// A point with a Jacobian of zero or less was found.
    pub inverted: u64,
    /// Too close to zero for a proof of the sign.
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

impl MappedMuscleDocument {
    pub fn without_lines(muscle: &MuscleDocument) -> Self {
        MappedMuscleDocument {
            name: muscle.name.clone(),
            lines: 0,
            template_length_mm: 0.0,
            length_mm: 0.0,
            widening: 1.0,
            template_volume_ml: None,
            volume_ml: None,
            beside_other_map: None,
        }
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
