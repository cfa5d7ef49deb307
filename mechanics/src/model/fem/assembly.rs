//! The stiffness matrix of a mesh.

use super::cell_stiffness::{Dilatation, cell_stiffness, tetrahedron};
use super::membrane::Membrane;
use crate::material::elastic_tensor::add_isotropic_pair;
use crate::material::{ElasticTensor, LinearElastic};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::dofs::DofMap;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::Block;
use crate::solver::half_matrix::{HalfMatrix, RowChunk};
use crate::vectorised::vectorised;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Rows that one thread assembles at a time.
const ROW_CHUNK: usize = 1024;

/// Tissue as an element formulation sees it.
#[derive(Clone, Copy)]
pub struct Tissue<'a> {
    pub mesh: &'a VolumeMesh,
    pub materials: &'a [LinearElastic],
    /// For each cell its entry in `materials`.
    pub material_of_cell: &'a [u16],
    /// For each cell the number of its kind of tissue: cells of one kind share a pressure at a node. A mixture is of the kind of its
    /// largest part, so that tissue that changes from cell to cell keeps a continuous pressure.
    pub pressure_of_cell: &'a [u16],
    /// For each cell the direction of its fibres, of length 1; empty where no material has fibres.
    pub fibres: &'a [Vector],
    pub membrane: Option<&'a Membrane>,
    pub dilatation: fn(CellShape) -> Dilatation,
}

impl<'a> Tissue<'a> {
    /// Tissue without fibres, whose skin is like the rest.
    pub fn isotropic(
        mesh: &'a VolumeMesh,
        materials: &'a [LinearElastic],
        material_of_cell: &'a [u16],
        dilatation: fn(CellShape) -> Dilatation,
    ) -> Self {
        Tissue {
            mesh,
            materials,
            material_of_cell,
            pressure_of_cell: material_of_cell,
            fibres: &[],
            membrane: None,
            dilatation,
        }
    }
}

/// Data of an isotropic tetrahedron for the assembly by rows: gradients of the shape functions, and lambda V and mu V.
#[derive(Clone, Copy)]
struct Simplex {
    gradients: [Vector; 4],
    lambda: f64,
    mu: f64,
}

impl Tissue<'_> {
    /// K over all nodes, held or not, in kPa mm.
    pub fn assemble(
        &self,
        dof_map: &DofMap,
        progress: &dyn Progress,
    ) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
        self.assemble_with(dof_map, progress, &|cell| self.tensor(cell))
    }

    /// The stiffness of the tissue of a cell.
    pub fn tensor(&self, cell: usize) -> ElasticTensor {
        let direction = self.fibres.get(cell).copied().unwrap_or_default();
        self.materials[self.material_of_cell[cell] as usize].tensor(&direction)
    }

    /// K with another stiffness for each cell. The membrane is part of it.
    pub(super) fn assemble_with(
        &self,
        dof_map: &DofMap,
        progress: &dyn Progress,
        tensor: &(dyn Fn(usize) -> ElasticTensor + Sync),
    ) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
        let mut matrix = HalfMatrix::zeros(dof_map.pattern.clone());
        let order = &dof_map.ordering.element_order;
        // Collected in place: a `Result` of them would be made in pieces and copied.
        let inverted = AtomicUsize::new(usize::MAX);
        let simplex = |&cell: &u32| {
            let made = self.simplex(cell as usize, &tensor(cell as usize));
            made.unwrap_or_else(|InvertedCell { cell }| {
                inverted.fetch_min(cell, Ordering::Relaxed);
                None
            })
        };
        let simplices: Vec<Option<Simplex>> = order.par_iter().map(simplex).collect();
        match inverted.into_inner() {
            usize::MAX => {}
            cell => return Err(InvertedCell { cell }),
        }
        if progress.is_cancelled() {
            return Ok(None);
        }
        matrix.row_chunks(ROW_CHUNK).into_par_iter().for_each_init(
            || vec![0_u32; dof_map.pattern.rows()],
            |at, mut chunk| {
                vectorised(
                    #[inline(always)]
                    || add_rows(dof_map, &simplices, &mut chunk, at),
                );
            },
        );
        let others: Vec<usize> =
            (0..order.len()).filter(|&element| simplices[element].is_none()).collect();
        let finished = dof_map.add_cells(&mut matrix, &others, progress, |cell| {
            self.cell_matrix(cell, &tensor(cell))
        })?;
        if let Some(membrane) = self.membrane {
            membrane.add_linear(&mut matrix, dof_map, self.mesh);
        }
        Ok(finished.then_some(matrix))
    }

    /// `None` for cells that are not isotropic tetrahedra.
    fn simplex(
        &self,
        cell: usize,
        tensor: &ElasticTensor,
    ) -> Result<Option<Simplex>, InvertedCell> {
        if self.mesh.cells.shape(cell) != CellShape::Tet4 || tensor.fibre.is_some() {
            return Ok(None);
        }
        let (volume, gradients) = tetrahedron(self.mesh, cell)?;
        let (lambda, mu) = (tensor.lambda * volume, tensor.mu * volume);
        Ok(Some(Simplex { gradients, lambda, mu }))
    }

    fn cell_matrix(&self, cell: usize, tensor: &ElasticTensor) -> Result<Vec<Block>, InvertedCell> {
        let mut corners = [Vector::zeros(); crate::element::MAX_NODES];
        let mut count = 0;
        for (slot, corner) in corners.iter_mut().zip(self.mesh.corners(cell)) {
            *slot = corner;
            count += 1;
        }
        let shape = self.mesh.cells.shape(cell);
        cell_stiffness(shape, &corners[..count], tensor, (self.dilatation)(shape))
            .ok_or(InvertedCell { cell })
    }
}

impl Simplex {
    #[inline(always)]
    fn add_block(&self, j: usize, k: usize, block: &mut Block) {
        add_isotropic_pair(block, [&self.gradients[j], &self.gradients[k]], self.lambda, self.mu);
    }
}

/// Row by row: no two threads write to the same block, and cells are added in their order. `at` is
/// scratch: where the block of each column of the row lies.
#[inline(always)]
fn add_rows(
    dof_map: &DofMap,
    simplices: &[Option<Simplex>],
    chunk: &mut RowChunk<f64, 3>,
    at: &mut [u32],
) {
    let begin = dof_map.pattern.range(chunk.first).start;
    for (local, diagonal) in chunk.diagonal.iter_mut().enumerate() {
        let row = chunk.first + local;
        let offset = dof_map.pattern.range(row).start - begin;
        for (k, &column) in dof_map.pattern.columns(row).iter().enumerate() {
            at[column as usize] = (offset + k) as u32;
        }
        for &element in dof_map.around.row(row) {
            let Some(simplex) = &simplices[element as usize] else { continue };
            let members = dof_map.connectivity.row(element as usize);
            let Some(j) = members.iter().position(|&member| member as usize == row) else {
                continue;
            };
            simplex.add_block(j, j, diagonal);
            for (k, &column) in members.iter().enumerate() {
                if (column as usize) < row {
                    simplex.add_block(j, k, &mut chunk.lower[at[column as usize] as usize]);
                }
            }
        }
    }
}
