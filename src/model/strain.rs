//! Measures of deformation of each cell, from nodal displacement.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::reference_cell;
use crate::element::PhysicalPoint;
use crate::mesh::{Vector, VolumeMesh};

/// How one cell is deformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellDeformation {
    /// The smallest determinant of F = I + grad u over the quadrature points.
    pub det_f: f64,
    /// Eigenvalues of the small strain at the centre, largest first.
    pub principal_strain: [f64; 3],
}

/// The deformation of every cell, in cell order.
pub fn deformations(mesh: &VolumeMesh, displacement: &[Vector]) -> Vec<CellDeformation> {
    (0..mesh.cells.len())
        .into_par_iter()
        .map(|cell| deformation(mesh, displacement, cell))
        .collect()
}

fn deformation(mesh: &VolumeMesh, displacement: &[Vector], cell: usize) -> CellDeformation {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let moved: Vec<Vector> =
        mesh.cells.nodes(cell).iter().map(|&node| displacement[node as usize]).collect();
    let reference = reference_cell(mesh.cells.shape(cell));
    let gradient = |point: &PhysicalPoint| {
        moved
            .iter()
            .zip(&point.gradients)
            .fold(Matrix3::zeros(), |sum: Matrix3<f64>, (u, g)| sum + u * g.transpose())
    };
    let det_f = reference
        .points
        .iter()
        .filter_map(|point| point.at(&corners))
        .map(|point| (Matrix3::identity() + gradient(&point)).determinant())
        .fold(f64::INFINITY, f64::min);
    let at_centre =
        reference.centre.at(&corners).map_or(Matrix3::zeros(), |point| gradient(&point));
    let strain = (at_centre + at_centre.transpose()) * 0.5;
    let mut principal_strain: [f64; 3] = strain.symmetric_eigenvalues().into();
    principal_strain.sort_by(|a, b| b.total_cmp(a));
    CellDeformation { det_f, principal_strain }
}
