//! Loads on the functions of edges: gravity, tractions and pressures of faces, growth and muscles. Forces at nodes do not,
//! because these functions are zero there.

use super::edge_functions::{Corners, MAX_EDGES, at_point};
use super::edges::Edges;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::inner_stress::InnerStress;
use crate::model::fem::loads::{FaceLoad, on_face_edges};
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// Loads that act on more than nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DistributedLoads {
    pub faces: Vec<(Vec<BoundaryFace>, FaceLoad)>,
    /// In mm/ms².
    pub acceleration: Vector,
    /// Growth and muscles that pull.
    pub inner: InnerStress,
}

impl DistributedLoads {
    /// Adds f(phi) of each edge, in mN.
    pub(super) fn add_to(
        &self,
        tissue: &Tissue,
        edges: &Edges,
        has_pressure: &(dyn Fn(usize) -> bool + Sync),
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
        if self.acceleration == Vector::zeros() && self.inner.is_empty() {
            return Ok(());
        }
        edges.each_cell(
            [Vector::zeros(); MAX_EDGES],
            |cell, _, weights| {
                *weights = self.weights(tissue, cell, has_pressure(cell))?;
                Ok(())
            },
            |_, edges, weights| {
                edges.numbers().zip(weights).for_each(|(edge, weight)| forces[edge] += weight);
            },
        )
    }

    /// int phi rho g dV - int S0 grad phi dV of each edge of a cell, int phi dV = V/5 on a tetrahedron.
    fn weights(
        &self,
        tissue: &Tissue,
        cell: usize,
        has_pressure: bool,
    ) -> Result<[Vector; MAX_EDGES], InvertedCell> {
        let shape = tissue.mesh.cells.shape(cell);
        let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
        let density = tissue.materials[tissue.material_of_cell[cell] as usize].density();
        let inner = self.inner.stress(tissue, cell, has_pressure).unwrap_or_default();
        let mut volumes = [0.0; MAX_EDGES];
        let mut slopes = [Vector::zeros(); MAX_EDGES];
        for point in &reference_cell(shape).points {
            let physical = point.at(&corners).ok_or(InvertedCell { cell })?;
            let (values, gradients) = (&point.values, &physical.gradients);
            let of_edges = at_point(shape, &Corners { values, gradients });
            for (slope, gradient) in slopes.iter_mut().zip(of_edges.gradients) {
                *slope += gradient * physical.volume;
            }
            for (volume, value) in volumes.iter_mut().zip(of_edges.values) {
                *volume += match shape {
                    CellShape::Tet4 => 0.2 * physical.volume,
                    CellShape::Hex8 | CellShape::Wedge6 => value * physical.volume,
                };
            }
        }
        Ok(std::array::from_fn(|edge| {
            self.acceleration * (density * volumes[edge]) - inner * slopes[edge]
        }))
    }
}
