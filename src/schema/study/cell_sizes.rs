//! Convergence of the skin over cell sizes, in a report.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::study::cell_sizes::{CellSizes, MeshPoint};

/// One face on meshes of several cell sizes, by one variant on one plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CellSizesDocument {
    pub series: String,
    pub plan: String,
    pub material: String,
    /// The variant.
    pub label: String,
    /// Coarsest first.
    pub meshes: Vec<CellSizeDocument>,
    /// p of m(h) = m* + c h^p, a least-squares fit to as many of the finest meshes as are consistent, at least four if there are as
    /// many; absent with fewer than three sizes, and without convergence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub order: Option<f64>,
    /// m*.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub limit_mm: Option<f64>,
    /// Root mean square distance of the meshes from the fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fit_rms_mm: Option<f64>,
    /// The number of the finest meshes in the fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fit_meshes: Option<u64>,
    /// The coarsest size below which no mesh changes the mean movement of the skin by more than .3 %; absent if the last
    /// step does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub settled_mm: Option<f64>,
}

/// The skin on one of the meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CellSizeDocument {
    pub scene: String,
    /// Edge of a cube with the volume of six tetrahedra, two wedges or one hexahedron in the mean.
    pub cell_mm: f64,
    pub cells: u64,
    pub unknowns: u64,
    pub wall_s: f64,
    /// Mean displacement of the skin, by area.
    pub skin_mean_mm: f64,
    /// Relative change from the mesh before; absent for the coarsest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub change: Option<f64>,
}

impl From<&CellSizes> for CellSizesDocument {
    fn from(of: &CellSizes) -> Self {
        CellSizesDocument {
            series: of.series.clone(),
            plan: of.plan.clone(),
            material: of.material.clone(),
            label: of.label.clone(),
            meshes: of.meshes.iter().map(CellSizeDocument::from).collect(),
            order: of.fit.map(|fit| fit.order),
            limit_mm: of.fit.map(|fit| fit.limit),
            fit_rms_mm: of.fit.map(|fit| fit.rms),
            fit_meshes: of.fit.map(|fit| fit.meshes as u64),
            settled_mm: of.settled,
        }
    }
}

impl From<&MeshPoint> for CellSizeDocument {
    fn from(mesh: &MeshPoint) -> Self {
        CellSizeDocument {
            scene: mesh.scene.clone(),
            cell_mm: mesh.cell,
            cells: mesh.cells as u64,
            unknowns: mesh.unknowns as u64,
            wall_s: mesh.wall_s,
            skin_mean_mm: mesh.skin_mean,
            change: mesh.change,
        }
    }
}
