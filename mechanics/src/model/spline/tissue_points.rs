//! The points at which tissue is integrated: those of the cells' own quadrature rules, and four in each
//! tetrahedron.

use crate::element::tetrahedron10;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// A point, and the tissue that it stands for.
#[derive(Clone, Copy, Debug)]
pub struct TissuePoint {
    pub position: Vector,
    /// In mm³.
    pub volume: f64,
    pub cell: u32,
}

/// The points of all cells, in cell order.
pub fn tissue_points(mesh: &VolumeMesh) -> Result<Vec<TissuePoint>, InvertedCell> {
    let mut points = Vec::with_capacity(8 * mesh.cells.len());
    let barycentric = tetrahedron10::points();
    for (cell, (shape, _)) in mesh.cells.iter().enumerate() {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let at = |weights: &[f64]| {
            corners.iter().zip(weights).fold(Vector::zeros(), |sum, (x, weight)| sum + x * *weight)
        };
        if shape == CellShape::Tet4 {
            let (volume, _) = tetrahedron(mesh, cell)?;
            let quarter = volume / 4.0;
            points.extend(barycentric.iter().map(|weights| TissuePoint {
                position: at(weights),
                volume: quarter,
                cell: cell as u32,
            }));
            continue;
        }
        for point in &reference_cell(shape).points {
            let volume = point.at(&corners).ok_or(InvertedCell { cell })?.volume;
            points.push(TissuePoint { position: at(&point.values), volume, cell: cell as u32 });
        }
    }
    Ok(points)
}
