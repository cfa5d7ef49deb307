//! What acts on the functions of edges: gravity, and tractions and pressures of faces. Forces at nodes do not, because these
//! functions are zero there.

use super::edge_functions::{Corners, MAX_EDGES, at_point};
use super::edges::Edges;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::loads::{FaceLoad, on_face_edges};
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// Loads that act on more than nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DistributedLoads {
    pub faces: Vec<(Vec<BoundaryFace>, FaceLoad)>,
    /// In mm/ms².
    pub acceleration: Vector,
}

impl DistributedLoads {
    /// Adds f(phi) of each edge, in mN.
    pub(super) fn add_to(
        &self,
        tissue: &Tissue,
        edges: &Edges,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        for (faces, load) in &self.faces {
            for face in faces {
                for ([a, b], force) in on_face_edges(tissue.mesh, face, *load) {
                    if let Some(edge) = edges.between(a, b) {
                        forces[edge] += force;
                    }
                }
            }
        }
        if self.acceleration == Vector::zeros() {
            return Ok(());
        }
        edges.each_cell(
            [Vector::zeros(); MAX_EDGES],
            |cell, _, weights| {
                *weights = self.weights(tissue, cell)?;
                Ok(())
            },
            |_, edges, weights| {
                edges.numbers().zip(weights).for_each(|(edge, weight)| forces[edge] += weight);
            },
        )
    }

    /// int phi rho g dV of each edge of a cell; V/5 on a tetrahedron.
    fn weights(&self, tissue: &Tissue, cell: usize) -> Result<[Vector; MAX_EDGES], InvertedCell> {
        let shape = tissue.mesh.cells.shape(cell);
        let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
        let density = tissue.materials[tissue.material_of_cell[cell] as usize].density();
        let mut volumes = [0.0; MAX_EDGES];
        for point in &reference_cell(shape).points {
            let physical = point.at(&corners).ok_or(InvertedCell { cell })?;
            let (values, gradients) = (&point.values, &physical.gradients);
            let of_edges = at_point(shape, &Corners { values, gradients }).values;
            for (volume, value) in volumes.iter_mut().zip(of_edges) {
                *volume += match shape {
                    CellShape::Tet4 => 0.2 * physical.volume,
                    CellShape::Hex8 | CellShape::Wedge6 => value * physical.volume,
                };
            }
        }
        Ok(volumes.map(|volume| self.acceleration * (density * volume)))
    }
}
