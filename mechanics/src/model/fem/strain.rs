//! Measures of deformation of each cell, from nodal displacement.
//!
//! F = I + grad u, strain (grad u + grad u^T) / 2; the rotation theta of F = R U from
//! tan theta = |w| / (tr F - 1), w_i = -e_ijk F_jk: exact where U does not shear out of the plane in which R turns
//! and keeps lengths across it. A stretch of 1 + e along the axis of R changes it by -(e/2) sin theta to first order.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::element::PhysicalPoint;
use crate::mesh::{CellShape, Vector, VolumeMesh, Warning};
use crate::model::reference_cell;

/// The code of [`inverted_cells`].
pub const INVERTED: &str = "cells-inverted";

/// Edges of a corner whose volume is less than this part of the product of their lengths lie in a plane.
const FLAT: f64 = 1e-6;

/// How one cell is deformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellDeformation {
    /// The smallest determinant of F = I + grad u over the quadrature points.
    pub det_f: f64,
    /// The small strain at the centre.
    pub strain: Matrix3<f64>,
    /// By how much F turns at the centre, in radians, in [0, pi].
    pub rotation: f64,
}

impl CellDeformation {
    /// Eigenvalues of the small strain at the centre, largest first.
    pub fn principal_strain(&self) -> [f64; 3] {
        let mut principal: [f64; 3] = self.strain.symmetric_eigenvalues().into();
        principal.sort_by(|a, b| b.total_cmp(a));
        principal
    }
}

/// The deformation of every cell, in cell order.
pub fn deformations(mesh: &VolumeMesh, displacement: &[Vector]) -> Vec<CellDeformation> {
    (0..mesh.cells.len())
        .into_par_iter()
        .map(|cell| deformation(mesh, displacement, cell))
        .collect()
}

/// The smallest det F of every cell over its quadrature points, in cell order: of its deformation that part alone.
pub fn determinants(mesh: &VolumeMesh, displacement: &[Vector]) -> Vec<f64> {
    let cells = (0..mesh.cells.len()).into_par_iter();
    cells.map(|cell| determinant(mesh, displacement, cell)).collect()
}

/// The same of one cell; infinite where it has no volume at rest.
pub fn determinant(mesh: &VolumeMesh, displacement: &[Vector], cell: usize) -> f64 {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let points = reference_cell(mesh.cells.shape(cell)).points.iter();
    points
        .filter_map(|point| point.at(&corners))
        .map(|point| gradient_of(mesh, displacement, cell, &point))
        .map(|gradient| determinant_of(&gradient))
        .fold(f64::INFINITY, f64::min)
}

/// det F of grad u.
fn determinant_of(gradient: &Matrix3<f64>) -> f64 {
    (Matrix3::identity() + gradient).determinant()
}

fn deformation(mesh: &VolumeMesh, displacement: &[Vector], cell: usize) -> CellDeformation {
    let at_centre = gradient_at_centre(mesh, displacement, cell);
    let det_f = match mesh.cells.shape(cell) {
        // Its gradient is the same everywhere.
        CellShape::Tet4 if at_centre != Matrix3::zeros() => determinant_of(&at_centre),
        CellShape::Tet4 | CellShape::Hex8 | CellShape::Wedge6 => {
            determinant(mesh, displacement, cell)
        }
    };
    let strain = (at_centre + at_centre.transpose()) * 0.5;
    CellDeformation { det_f, strain, rotation: rotation(&at_centre) }
}

/// grad u at the centre of a cell; zero of a cell without volume.
pub fn gradient_at_centre(mesh: &VolumeMesh, displacement: &[Vector], cell: usize) -> Matrix3<f64> {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let centre = reference_cell(mesh.cells.shape(cell)).centre.at(&corners);
    centre.map_or(Matrix3::zeros(), |point| gradient_of(mesh, displacement, cell, &point))
}

/// The smallest det F of every cell over its corners, in cell order, where edges have the volume of the corner at rest: hexahedra and
/// wedges may turn inside out at corners alone. Infinite for tetrahedra and where a cell has no such corner.
pub fn determinants_at_corners(mesh: &VolumeMesh, displacement: &[Vector]) -> Vec<f64> {
    let cells = (0..mesh.cells.len()).into_par_iter();
    cells.map(|cell| determinant_at_corners(mesh, displacement, cell)).collect()
}

fn determinant_at_corners(mesh: &VolumeMesh, displacement: &[Vector], cell: usize) -> f64 {
    let (shape, nodes) = (mesh.cells.shape(cell), mesh.cells.nodes(cell));
    if shape == CellShape::Tet4 {
        return f64::INFINITY;
    }
    let rest = |corner: usize| mesh.nodes[nodes[corner] as usize];
    let moved = |corner: usize| rest(corner) + displacement[nodes[corner] as usize];
    let at_corner = |corner: usize| {
        let others = shape.edges().iter().filter(|edge| edge.contains(&corner));
        let others: Vec<usize> = others.map(|&[a, b]| a + b - corner).collect();
        let edges = |at: &dyn Fn(usize) -> Vector| -> Matrix3<f64> {
            Matrix3::from_columns(&[0, 1, 2].map(|side| at(others[side]) - at(corner)))
        };
        // The order of the edges is that of the cell, which may be the other way round at this corner.
        let at_rest = edges(&rest);
        let lengths: f64 = at_rest.column_iter().map(|edge| edge.norm()).product();
        let volume = at_rest.determinant();
        let is_corner = volume.abs() > FLAT * lengths;
        if is_corner { edges(&moved).determinant() / volume } else { f64::INFINITY }
    };
    (0..nodes.len()).map(at_corner).fold(f64::INFINITY, f64::min)
}

/// An answer that turns cells inside out says so, by the smallest det F of every cell.
pub fn inverted_cells(determinants: &[f64]) -> Option<Warning> {
    let inverted = determinants.iter().filter(|det_f| **det_f <= 0.0).count();
    let smallest = determinants.iter().copied().fold(f64::INFINITY, f64::min);
    let detail = format!("the displacement turns {inverted} cells inside out");
    let warning = Warning::new(INVERTED, detail)
        .with("cells", inverted as f64)
        .with("share", inverted as f64 / determinants.len().max(1) as f64);
    (inverted > 0).then(|| warning.with("smallest_det_f", smallest))
}

fn gradient_of(
    mesh: &VolumeMesh,
    displacement: &[Vector],
    cell: usize,
    point: &PhysicalPoint,
) -> Matrix3<f64> {
    let moved = mesh.cells.nodes(cell).iter().map(|&node| displacement[node as usize]);
    moved
        .zip(&point.gradients)
        .fold(Matrix3::zeros(), |sum: Matrix3<f64>, (u, g)| sum + u * g.transpose())
}

/// The angle of I + grad u in radians.
fn rotation(gradient: &Matrix3<f64>) -> f64 {
    let h = gradient;
    let twice_sine =
        Vector::new(h[(2, 1)] - h[(1, 2)], h[(0, 2)] - h[(2, 0)], h[(1, 0)] - h[(0, 1)]);
    twice_sine.norm().atan2(2.0 + h.trace())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::sample::block;

    #[test]
    fn a_hexahedron_folded_at_one_corner_only_has_a_negative_determinant() {
        let mesh = block(Vector::new(1.0, 1.0, 1.0), [1, 1, 1], CellShape::Hex8);
        let mut displacement = vec![Vector::zeros(); 8];
        let corner = mesh.nodes.iter().position(|x| *x == Vector::new(1.0, 1.0, 1.0));
        displacement[corner.expect("a unit cube has this corner")] = Vector::new(-0.9, -0.9, -0.9);
        let folded = deformations(&mesh, &displacement)[0];
        assert!(folded.det_f < 0.0, "{}", folded.det_f);
    }

    #[test]
    fn a_hexahedron_may_fold_at_a_corner_beside_its_quadrature_points() {
        let mesh = block(Vector::new(1.0, 1.0, 1.0), [1, 1, 1], CellShape::Hex8);
        let mut displacement = vec![Vector::zeros(); 8];
        let corner = mesh.nodes.iter().position(|x| *x == Vector::new(1.0, 1.0, 1.0)).unwrap();
        displacement[corner] = Vector::new(-0.4, -0.4, -0.4);
        assert!(deformations(&mesh, &displacement)[0].det_f > 0.05);
        // 1 - 3 x 0.4.
        let at_corners = determinants_at_corners(&mesh, &displacement)[0];
        assert!((at_corners + 0.2).abs() < 1e-14, "{at_corners}");
    }

    #[test]
    fn a_stretch_along_z_is_the_largest_principal_strain() {
        let mesh = block(Vector::new(2.0, 2.0, 2.0), [1, 1, 1], CellShape::Wedge6);
        let stretched: Vec<Vector> =
            mesh.nodes.iter().map(|x| Vector::new(-0.01 * x.x, 0.0, 0.02 * x.z)).collect();
        for cell in deformations(&mesh, &stretched) {
            for (found, expected) in cell.principal_strain().iter().zip([0.02, 0.0, -0.01]) {
                assert!((found - expected).abs() < 1e-15);
            }
            assert!((cell.det_f - 0.99 * 1.02).abs() < 1e-15);
        }
    }

    #[test]
    fn tissue_that_turns_and_stretches_turns_by_the_angle_it_was_turned_by() {
        let mesh = block(Vector::new(2.0, 2.0, 2.0), [1, 1, 1], CellShape::Hex8);
        let stretch = Matrix3::from_diagonal(&Vector::new(1.2, 1.0, 0.7));
        for degrees in [0.0_f64, 7.0, 45.0, 120.0, 180.0] {
            let turn =
                nalgebra::Rotation3::from_axis_angle(&Vector::y_axis(), degrees.to_radians());
            let moved = |x: &Vector| turn * stretch * x - x;
            let displacement: Vec<Vector> = mesh.nodes.iter().map(moved).collect();
            let found = deformations(&mesh, &displacement)[0].rotation.to_degrees();
            // At 180 degrees the sine is zero to rounding only.
            assert!((found - degrees).abs() < 1e-7, "{degrees}: {found}");
        }
    }
}
