//! The stiffness matrix of a mesh.

use rayon::prelude::*;

use super::stiffness::{Dilatation, cell_stiffness};
use crate::boundary::Hold;
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::solver::{Block, BlockMatrix};

/// Cells whose matrices are computed side by side before they are added in cell order, which keeps the
/// bits independent of the number of threads.
const CHUNK: usize = 4096;

/// Tissue as an element formulation sees it.
pub struct Tissue<'a> {
    pub mesh: &'a VolumeMesh,
    pub materials: &'a [LinearElastic],
    /// For each cell its entry in `materials`.
    pub material_of_cell: &'a [u16],
    pub dilatation: fn(CellShape) -> Dilatation,
}

/// A cell whose Jacobian is not positive at a quadrature point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("cell {cell} is inverted or flat")]
pub struct InvertedCell {
    pub cell: usize,
}

impl Tissue<'_> {
    fn cell_matrix(&self, cell: usize) -> Result<Vec<Block>, InvertedCell> {
        let mut corners = [Vector::zeros(); crate::element::MAX_NODES];
        let mut count = 0;
        for (slot, corner) in corners.iter_mut().zip(self.mesh.corners(cell)) {
            *slot = corner;
            count += 1;
        }
        let shape = self.mesh.cells.shape(cell);
        let material = &self.materials[self.material_of_cell[cell] as usize];
        cell_stiffness(shape, &corners[..count], material, (self.dilatation)(shape))
            .ok_or(InvertedCell { cell })
    }

    /// K over all nodes, held or not, in kPa mm.
    pub fn assemble(
        &self,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<Option<BlockMatrix>, InvertedCell> {
        let cells = &self.mesh.cells;
        let cliques = (0..cells.len()).map(|cell| cells.nodes(cell));
        let mut matrix = BlockMatrix::from_cliques(self.mesh.nodes.len(), cliques);
        for begin in (0..cells.len()).step_by(CHUNK) {
            if !keep_going() {
                return Ok(None);
            }
            let chunk = begin..(begin + CHUNK).min(cells.len());
            let matrices: Vec<Result<Vec<Block>, InvertedCell>> =
                chunk.clone().into_par_iter().map(|cell| self.cell_matrix(cell)).collect();
            for (cell, blocks) in chunk.zip(matrices) {
                add_cell(&mut matrix, cells.nodes(cell), &blocks?);
            }
        }
        Ok(Some(matrix))
    }
}

fn add_cell(matrix: &mut BlockMatrix, nodes: &[u32], blocks: &[Block]) {
    for (j, &row) in nodes.iter().enumerate() {
        for (k, &column) in nodes.iter().enumerate() {
            let sum = matrix.block_mut(row as usize, column as usize);
            for (sum, value) in sum.iter_mut().zip(&blocks[j * nodes.len() + k]) {
                *sum += value;
            }
        }
    }
}

/// Writes the rows and columns of nodes with a frame of their own in that frame: Q^T K Q.
pub fn rotate_into_frames(matrix: &mut BlockMatrix, holds: &[Hold]) {
    for hold in holds.iter().filter(|hold| !hold.is_aligned()) {
        let node = hold.node as usize;
        let q = hold.axes();
        for neighbour in matrix.columns(node).to_vec() {
            let neighbour = neighbour as usize;
            let row = matrix.block_mut(node, neighbour);
            let old = *row;
            *row =
                std::array::from_fn(|e| (0..3).map(|m| q[(m, e / 3)] * old[3 * m + e % 3]).sum());
            let column = matrix.block_mut(neighbour, node);
            let old = *column;
            *column =
                std::array::from_fn(|e| (0..3).map(|m| old[3 * (e / 3) + m] * q[(m, e % 3)]).sum());
        }
    }
}
