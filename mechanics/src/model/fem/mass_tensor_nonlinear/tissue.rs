//! Tensors of all tetrahedra of a mesh, with their forces and tangent.

use rayon::prelude::*;

use super::tensors::{Constants, Differences, Tensors};
use crate::material::LinearElastic;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::DofMap;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::SolverError;
use crate::solver::half_matrix::HalfMatrix;

/// What the last digits of a sum of a few terms lose, with some room.
const ROUNDING: f64 = 1e-15;

/// Cells that one thread takes at a time; the sums of the chunks are added in their order.
const CHUNK: usize = 1024;

pub(super) struct Tetrahedra<'a> {
    pub mesh: &'a VolumeMesh,
    tensors: Vec<Tensors>,
}

impl<'a> Tetrahedra<'a> {
    pub fn new(
        mesh: &'a VolumeMesh,
        materials: &[LinearElastic],
        material_of_cell: &[u16],
    ) -> Result<Self, InvertedCell> {
        let constants: Vec<Constants> = materials
            .iter()
            .map(|material| Constants { lambda: material.lambda(), mu: material.shear_modulus() })
            .collect();
        let cell = |(cell, &material): (usize, &u16)| {
            Tensors::new(mesh, cell, constants[usize::from(material)])
        };
        let tensors =
            material_of_cell.par_iter().enumerate().map(cell).collect::<Result<_, _>>()?;
        Ok(Tetrahedra { mesh, tensors })
    }

    pub fn megabytes(&self) -> f64 {
        (self.tensors.len() * size_of::<Tensors>()) as f64 / 1e6
    }

    fn differences(&self, cell: usize, u: &[Vector]) -> Differences {
        let nodes = self.mesh.cells.nodes(cell);
        std::array::from_fn(|k| u[nodes[k + 1] as usize] - u[nodes[0] as usize])
    }

    /// In mN mm.
    pub fn energy(&self, u: &[Vector]) -> f64 {
        let energy = |(chunk, tensors): (usize, &[Tensors])| -> f64 {
            let cells = (chunk * CHUNK..).zip(tensors);
            cells.map(|(cell, tensors)| tensors.energy(&self.differences(cell, u))).sum()
        };
        let sums: Vec<f64> = self.tensors.par_chunks(CHUNK).enumerate().map(energy).collect();
        sums.iter().sum()
    }

    /// Internal forces in mN, for each node.
    pub fn forces(&self, u: &[Vector]) -> Vec<Vector> {
        let of_cells: Vec<[Vector; 4]> = self
            .tensors
            .par_iter()
            .enumerate()
            .map(|(cell, tensors)| tensors.forces(&self.differences(cell, u)))
            .collect();
        let mut forces = vec![Vector::zeros(); u.len()];
        for ((_, nodes), own) in self.mesh.cells.iter().zip(&of_cells) {
            nodes.iter().zip(own).for_each(|(&node, force)| forces[node as usize] += force);
        }
        forces
    }

    /// The derivatives of the forces by the displacements, in mN/mm.
    pub fn tangent(
        &self,
        u: &[Vector],
        dof_map: &DofMap,
        progress: &dyn Progress,
    ) -> Result<HalfMatrix<f64, 3>, SolverError> {
        let mut matrix = HalfMatrix::zeros(dof_map.pattern.clone());
        let all: Vec<usize> = (0..self.tensors.len()).collect();
        let blocks = |cell: usize| Ok(self.tensors[cell].tangent(&self.differences(cell, u)));
        match dof_map.add_cells(&mut matrix, &all, progress, blocks) {
            Ok(true) => Ok(matrix),
            // No cell is inverted here: all were checked when their tensors were made.
            Ok(false) | Err(InvertedCell { .. }) => Err(SolverError::Stopped),
        }
    }

    /// What rounding leaves of energy in mN mm where nodes are moved by up to so many mm.
    pub fn energy_rounding(&self, moved: f64) -> f64 {
        let stiffness: f64 = self.tensors.iter().map(Tensors::stiffness).sum();
        ROUNDING * stiffness * moved * moved
    }

    /// What rounding leaves of forces in mN, their norm.
    pub fn force_rounding(&self, moved: f64) -> f64 {
        let squares: f64 = self.tensors.iter().map(|cell| cell.stiffness().powi(2)).sum();
        ROUNDING * squares.sqrt() * moved
    }
}
