//! Repair of distorted cells: bounds of node movement, and report.

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::mesh::quality::quality;
use mechanics::mesh::{VolumeMesh, Warning};
use mechanics::progress::Unobserved;
use mechanics::repair::{Bounds, RepairReport, repair};

/// The largest share of cells not proven valid that is repaired; beyond it a mesh has other faults.
const MOST_UNPROVEN: f64 = 0.1;
/// This number may always be repaired.
const FEW_UNPROVEN: usize = 100;
/// The number of cells named in a warning.
const NAMED: usize = 10;

/// Bounds of node movement in a repair, which makes every cell valid at every point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RepairDocument {
    /// Of nodes on the boundary, along the surface only; on skin and bone only of a conformation. 0 to 10 mm.
    #[serde(default = "one")]
    #[schema(default = 1.0)]
    pub boundary_mm: f64,
    /// Of other nodes, 0 to 10 mm.
    #[serde(default = "three")]
    #[schema(default = 3.0)]
    pub inner_mm: f64,
}

fn one() -> f64 {
    1.0
}

fn three() -> f64 {
    3.0
}

impl Default for RepairDocument {
    fn default() -> Self {
        RepairDocument { boundary_mm: one(), inner_mm: three() }
    }
}

/// The result of a repair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RepairResultDocument {
    /// Cells not proven valid at every point before.
    #[serde(default)]
    #[schema(required)]
    pub unproven_before: u64,
    pub sweeps: u64,
    pub nodes_moved: u64,
    pub mean_move_mm: f64,
    pub largest_move_mm: f64,
    /// Every cell not proven valid; empty if all are.
    pub unproven: Vec<UnprovenDocument>,
}

/// A cell that was not repaired within the bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnprovenDocument {
    /// From 0.
    pub cell: u64,
    pub smallest_jacobian_mm3: f64,
}

/// A mesh in mm after a repair, and its report.
pub struct RepairedMesh {
    pub volume: Arc<VolumeMesh>,
    pub report: RepairReport,
}

impl RepairDocument {
    pub fn check(&self, at: &Pointer, faults: &mut Faults) -> bool {
        let boundary = at.key("boundary_mm");
        let is_right = faults.check_range(&boundary, self.boundary_mm, 0.0..=10.0, "mm");
        faults.check_range(&at.key("inner_mm"), self.inner_mm, 0.0..=10.0, "mm") && is_right
    }

    /// A mesh in mm with its cells repaired, its boundary moved tangentially only. `None` if faults were added: a mesh of
    /// which many cells are distorted is refused.
    pub fn mended(
        &self,
        volume: &VolumeMesh,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<RepairedMesh> {
        if !self.check(at, faults) {
            return None;
        }
        let before = quality(volume);
        let (unproven, cells) = (before.inverted + before.undecided, before.cells);
        if unproven > FEW_UNPROVEN && unproven as f64 > MOST_UNPROVEN * cells as f64 {
            let detail = format!(
                "{unproven} of {cells} cells are not proven valid, and a repair takes {:.0} % of them at most: the mesh has other faults",
                100.0 * MOST_UNPROVEN
            );
            faults.add(at, ErrorCode::MeshInvertedElements, detail);
            return None;
        }
        let mut mesh = volume.clone();
        let mut boundary: Vec<u32> =
            mesh.boundary_faces().iter().flat_map(|face| face.nodes().to_vec()).collect();
        boundary.sort_unstable();
        boundary.dedup();
        let bounds = Bounds::of(&mesh, self.boundary_mm, self.inner_mm).along(&mesh, &[&boundary]);
        let report = repair(&mut mesh, &bounds, &Unobserved);
        Some(RepairedMesh { volume: Arc::new(mesh), report })
    }
}

impl RepairedMesh {
    /// The warning of a result, if not all cells were valid.
    pub fn warning(&self) -> Option<Warning> {
        let RepairReport { unproven_before, nodes_moved, largest_move, unproven, .. } =
            &self.report;
        if *unproven_before == 0 {
            return None;
        }
        let left = match unproven.len() {
            0 => "every cell is proven valid now".to_owned(),
            count => {
                let named = unproven.iter().take(NAMED).map(|own| own.cell.to_string());
                let named = named.collect::<Vec<_>>().join(", ");
                format!("{count} stay so, the first of them {named} (from 0)")
            }
        };
        let detail = format!(
            "{unproven_before} cells were not proven valid; {nodes_moved} nodes were moved by up to {largest_move:.2} mm, and {left}"
        );
        let warning = Warning::new("mesh-repaired", detail);
        let warning = warning.with("unproven_before", *unproven_before as f64);
        let warning = warning.with("unproven", unproven.len() as f64);
        Some(warning.with("largest_move_mm", *largest_move))
    }
}

impl From<&RepairReport> for RepairResultDocument {
    fn from(report: &RepairReport) -> Self {
        let unproven = report.unproven.iter().map(|cell| UnprovenDocument {
            cell: u64::from(cell.cell),
            smallest_jacobian_mm3: cell.smallest_jacobian,
        });
        RepairResultDocument {
            unproven_before: report.unproven_before as u64,
            sweeps: report.sweeps as u64,
            nodes_moved: report.nodes_moved as u64,
            mean_move_mm: report.mean_move,
            largest_move_mm: report.largest_move,
            unproven: unproven.collect(),
        }
    }
}

/// Refuses cells without a valid stiffness: those that no repair was requested for, or that it left.
pub fn check_cells(volume: &VolumeMesh, is_repaired: bool, at: &Pointer, faults: &mut Faults) {
    let cells = (0..volume.cells.len()).into_par_iter();
    let invalid: Vec<usize> =
        cells.filter(|&cell| !volume.cell_jacobian(cell).is_valid()).collect();
    let (Some(first), count) = (invalid.first(), invalid.len()) else { return };
    let (place, remedy) = match is_repaired {
        true => ("repair", "they remain so within the bounds of the repair: larger ones may help"),
        false => ("volume", "`repair` in the case may correct them"),
    };
    let detail = format!(
        "{count} of {} cells are inverted or flat at a Gauss point, the first of them {first} (from 0): {remedy}",
        volume.cells.len()
    );
    faults.add(&at.key(place), ErrorCode::MeshInvertedElements, detail);
}
