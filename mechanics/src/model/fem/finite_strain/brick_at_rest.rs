//! Hexahedra and wedges at rest, and tetrahedra with nodes in the middle of their edges.

use nalgebra::Matrix3;

use crate::element::tetrahedron10;
use crate::material::hyperelastic::VolumeEnergy;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::fem::inner_stress::Grown;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// A point of a cell at rest, as it has grown.
pub(super) struct PointAtRest {
    pub gradients: Vec<Vector>,
    /// In mm^3.
    pub volume: f64,
}

/// A hexahedron or wedge at rest.
pub(super) struct Brick {
    pub rows: Vec<u32>,
    pub points: Vec<PointAtRest>,
    /// In mm^3.
    pub volume: f64,
    pub law: u16,
    pub cell: usize,
    /// The energy of the mean of J; none where volume is taken at each point.
    pub of_mean: Option<VolumeEnergy>,
}

impl Brick {
    pub fn new(
        mesh: &VolumeMesh,
        cell: usize,
        rows: Vec<u32>,
        law: u16,
    ) -> Result<Brick, InvertedCell> {
        let points = match mesh.cells.shape(cell) {
            CellShape::Tet4 => quadratic_points(mesh, cell)?,
            CellShape::Hex8 | CellShape::Wedge6 => points(mesh, cell)?,
        };
        let volume = points.iter().map(|point| point.volume).sum();
        Ok(Brick { rows, points, volume, law, cell, of_mean: None })
    }

    pub fn grown(mut self, grown: Grown) -> Brick {
        for point in &mut self.points {
            point.gradients.iter_mut().for_each(|g| *g = grown.gradient(g));
            point.volume *= grown.volume;
        }
        self.volume *= grown.volume;
        self
    }

    /// Of its corners.
    pub fn positions(&self, x: &[Vector]) -> Vec<Vector> {
        self.rows.iter().map(|&row| x[row as usize]).collect()
    }
}

fn points(mesh: &VolumeMesh, cell: usize) -> Result<Vec<PointAtRest>, InvertedCell> {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let point = |point: &crate::element::ReferencePoint| {
        let at = point.at(&corners).ok_or(InvertedCell { cell })?;
        Ok(PointAtRest { gradients: at.gradients[..corners.len()].to_vec(), volume: at.volume })
    };
    reference_cell(mesh.cells.shape(cell)).points.iter().map(point).collect()
}

/// Those of a tetrahedron with ten nodes and straight edges.
fn quadratic_points(mesh: &VolumeMesh, cell: usize) -> Result<Vec<PointAtRest>, InvertedCell> {
    let (volume, of_barycentric) = tetrahedron(mesh, cell)?;
    let point = |point: &[f64; 4]| PointAtRest {
        gradients: tetrahedron10::gradients(point, &of_barycentric).to_vec(),
        volume: 0.25 * volume,
    };
    Ok(tetrahedron10::points().iter().map(point).collect())
}

impl PointAtRest {
    /// F for the positions of the corners.
    pub fn gradient(&self, corners: &[Vector]) -> Matrix3<f64> {
        corners.iter().zip(&self.gradients).map(|(x, g)| x * g.transpose()).sum()
    }
}
