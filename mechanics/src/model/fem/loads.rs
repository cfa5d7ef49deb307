//! Nodal forces in mN that do the same work as tractions, pressures and gravity.

use super::assembly::Tissue;
use super::cell_stiffness::tetrahedron;
use super::edge_nodes::EdgeNodes;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// Load on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceLoad {
    /// Force for each area in kPa.
    Traction(Vector),
    /// Along the inward normal, in kPa.
    Pressure(f64),
}

impl FaceLoad {
    /// The force in mN on a piece of a face.
    fn on(self, area_vector: &Vector) -> Vector {
        match self {
            FaceLoad::Traction(traction) => traction * area_vector.norm(),
            FaceLoad::Pressure(pressure) => -area_vector * pressure,
        }
    }
}

/// Adds f_i = int N_i t dA over the faces: exact for flat triangles, 2 x 2 Gauss points otherwise.
pub fn add_face_load(
    mesh: &VolumeMesh,
    faces: &[BoundaryFace],
    load: FaceLoad,
    forces: &mut [Vector],
) {
    for face in faces {
        let nodes = face.nodes();
        let corners: Vec<Vector> = nodes.iter().map(|&node| mesh.nodes[node as usize]).collect();
        for (values, area_vector) in face_points(&corners) {
            let force = load.on(&area_vector);
            for (&node, value) in nodes.iter().zip(values) {
                forces[node as usize] += force * value;
            }
        }
    }
}

/// Shape functions and area vectors at the quadrature points of a face.
fn face_points(corners: &[Vector]) -> Vec<([f64; 4], Vector)> {
    if let [a, b, c] = corners {
        let third = 1.0 / 3.0;
        return vec![([third, third, third, 0.0], (b - a).cross(&(c - a)) * 0.5)];
    }
    const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let gauss = 1.0 / 3.0_f64.sqrt();
    SIGNS
        .iter()
        .map(|[p, q]| {
            let (x, y) = (p * gauss, q * gauss);
            let values = SIGNS.map(|[a, b]| (1.0 + a * x) * (1.0 + b * y) / 4.0);
            let (mut along_x, mut along_y) = (Vector::zeros(), Vector::zeros());
            for ([a, b], corner) in SIGNS.iter().zip(corners) {
                along_x += corner * (a * (1.0 + b * y) / 4.0);
                along_y += corner * ((1.0 + a * x) * b / 4.0);
            }
            (values, along_x.cross(&along_y))
        })
        .collect()
}

/// int phi_ij t dA of each side of a face: a third of the area of a triangle, with 2 x 2 Gauss points otherwise, where phi is
/// 4 N_i N_j / (N_i + N_j).
pub(super) fn on_face_edges(
    mesh: &VolumeMesh,
    face: &BoundaryFace,
    load: FaceLoad,
) -> Vec<([u32; 2], Vector)> {
    let nodes = face.nodes();
    let corners: Vec<Vector> = nodes.iter().map(|&node| mesh.nodes[node as usize]).collect();
    let sides = 0..nodes.len();
    let mut forces: Vec<([u32; 2], Vector)> =
        sides.map(|k| ([nodes[k], nodes[(k + 1) % nodes.len()]], Vector::zeros())).collect();
    for (values, area_vector) in face_points(&corners) {
        let force = load.on(&area_vector);
        for (k, (_, sum)) in forces.iter_mut().enumerate() {
            let (a, b) = (values[k], values[(k + 1) % nodes.len()]);
            *sum += force * if nodes.len() == 3 { 1.0 / 3.0 } else { 4.0 * a * b / (a + b) };
        }
    }
    forces
}

/// Adds f_i = int N_i rho g dV; acceleration in mm/ms², density in mg/mm³.
pub fn add_gravity(
    tissue: &Tissue,
    acceleration: Vector,
    forces: &mut [Vector],
) -> Result<(), InvertedCell> {
    for (cell, (shape, nodes)) in tissue.mesh.cells.iter().enumerate() {
        let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
        let density = tissue.materials[tissue.material_of_cell[cell] as usize].density();
        for point in &reference_cell(shape).points {
            let volume = point.at(&corners).ok_or(InvertedCell { cell })?.volume;
            for (&node, value) in nodes.iter().zip(&point.values) {
                forces[node as usize] += acceleration * (density * value * volume);
            }
        }
    }
    Ok(())
}

impl EdgeNodes {
    /// Adds f_i = int N_i t dA over flat triangles: a third at the middle of each edge, nothing at corners.
    pub fn add_face_load(
        &self,
        mesh: &VolumeMesh,
        faces: &[BoundaryFace],
        load: FaceLoad,
        forces: &mut [Vector],
    ) {
        for [a, b, c] in faces.iter().flat_map(|face| face.triangles(&mesh.nodes)) {
            let [pa, pb, pc] = [a, b, c].map(|node| mesh.nodes[node as usize]);
            let area = (pb - pa).cross(&(pc - pa)) * 0.5;
            let force = load.on(&area);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                forces[self.between(from, to) as usize] += force / 3.0;
            }
        }
    }

    /// Adds f_i = int N_i rho g dV: -1/20 of the weight at each corner, 1/5 at each edge.
    pub fn add_gravity(
        &self,
        tissue: &Tissue,
        acceleration: Vector,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        for cell in 0..tissue.mesh.cells.len() {
            let (volume, _) = tetrahedron(tissue.mesh, cell)?;
            let density = tissue.materials[tissue.material_of_cell[cell] as usize].density();
            let weight = acceleration * (density * volume);
            for (k, node) in self.of_cell(tissue.mesh, cell).into_iter().enumerate() {
                forces[node as usize] += weight * if k < 4 { -0.05 } else { 0.2 };
            }
        }
        Ok(())
    }
}
