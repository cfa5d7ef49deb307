//! The answer of a conformation: how far the template is left from the patient, and what its cells are worth.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::CaseDocument;
use mechanics::mesh::quality::QualityReport;
use mechanics::repair::RepairReport;

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
    /// A case of the mesh, ready to be stored and predicted on.
    pub case: CaseDocument,
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

/// What moves of nodes mended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RepairResultDocument {
    pub sweeps: u64,
    pub nodes_moved: u64,
    pub mean_move_mm: f64,
    pub largest_move_mm: f64,
    /// Every cell that is not proven valid; empty where all are.
    pub unproven: Vec<UnprovenDocument>,
}

/// A cell that moves within the bounds did not mend.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnprovenDocument {
    /// From 0.
    pub cell: u64,
    pub smallest_jacobian_mm3: f64,
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

impl From<&RepairReport> for RepairResultDocument {
    fn from(report: &RepairReport) -> Self {
        let unproven = report.unproven.iter().map(|cell| UnprovenDocument {
            cell: u64::from(cell.cell),
            smallest_jacobian_mm3: cell.smallest_jacobian,
        });
        RepairResultDocument {
            sweeps: report.sweeps as u64,
            nodes_moved: report.nodes_moved as u64,
            mean_move_mm: report.mean_move,
            largest_move_mm: report.largest_move,
            unproven: unproven.collect(),
        }
    }
}
