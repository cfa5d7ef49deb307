//! The stiffness matrix of a mesh.

use std::sync::Arc;

use rayon::prelude::*;

use super::cell_stiffness::{Dilatation, cell_stiffness, tetrahedron};
use super::membrane::Membrane;
use crate::boundary::Hold;
use crate::material::elastic_tensor::add_isotropic_pair;
use crate::material::{ElasticTensor, LinearElastic};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::solver::cliques::{Cliques, CliquesOfRow};
use crate::solver::half_matrix::{HalfMatrix, Pattern, RowChunk};
use crate::solver::layout::Layout;
use crate::solver::{Block, PartlyHeld};

/// Cells whose matrices are computed side by side before they are added in cell order, which keeps the
/// bits independent of the number of threads.
const CHUNK: usize = 4096;

/// Rows that one thread assembles at a time.
const ROW_CHUNK: usize = 1024;

/// Tissue as an element formulation sees it.
#[derive(Clone, Copy)]
pub struct Tissue<'a> {
    pub mesh: &'a VolumeMesh,
    pub materials: &'a [LinearElastic],
    /// For each cell its entry in `materials`.
    pub material_of_cell: &'a [u16],
    /// For each cell the entry whose pressure it takes part in: its own, and for a mixture that of its largest
    /// part, so that tissue that changes from cell to cell keeps a continuous pressure.
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

/// A cell whose Jacobian is not positive at a quadrature point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("cell {cell} is inverted or flat")]
pub struct InvertedCell {
    pub cell: usize,
}

/// Where nodes and cells go in the matrix. It depends on the cells and on which nodes are held, and
/// serves any materials.
pub struct Numbering {
    pub layout: Arc<Layout>,
    pub pattern: Arc<Pattern>,
    /// Places of the nodes of each cell, cells in the order of the layout.
    cliques: Cliques,
    around: CliquesOfRow,
}

impl Numbering {
    /// For the nodes of a mesh. `held` tells those without a free unknown.
    pub fn new(mesh: &VolumeMesh, held: &[bool]) -> Self {
        Numbering::of(&nodes_of_cells(mesh), &mesh.nodes, held)
    }

    /// For nodes at positions that stand in cells of any kind.
    pub fn of(cliques: &Cliques, positions: &[Vector], held: &[bool]) -> Self {
        let rows = positions.len();
        let around = CliquesOfRow::new(cliques, rows);
        let layout = Layout::new(cliques, &around, held, 3, far_end(positions));
        let cliques = cliques.renumbered(&layout.clique_order, &layout.place);
        let around = CliquesOfRow::new(&cliques, rows);
        let pattern = Arc::new(Pattern::new(&cliques, &around, rows));
        Numbering { layout: Arc::new(layout), pattern, cliques, around }
    }

    /// Values of nodes in the order of rows.
    pub fn by_row<T: Copy>(&self, of_node: &[T]) -> Vec<T> {
        let mut by_row = of_node.to_vec();
        for (value, &row) in of_node.iter().zip(&self.layout.place) {
            by_row[row as usize] = *value;
        }
        by_row
    }

    /// The row of a node.
    pub fn row(&self, node: u32) -> usize {
        self.layout.place[node as usize] as usize
    }

    /// Adds the matrices of whole cells, given by their places in the order of the layout; false where it
    /// was told to stop.
    pub fn add_cells<M: AsRef<[Block]> + Send>(
        &self,
        matrix: &mut HalfMatrix<f64, 3>,
        cliques: &[usize],
        keep_going: &dyn Fn() -> bool,
        cell_matrix: impl Fn(usize) -> Result<M, InvertedCell> + Sync,
    ) -> Result<bool, InvertedCell> {
        for chunk in cliques.chunks(CHUNK) {
            if !keep_going() {
                return Ok(false);
            }
            let cell = |&clique: &usize| cell_matrix(self.layout.clique_order[clique] as usize);
            let matrices: Vec<Result<M, InvertedCell>> = chunk.par_iter().map(cell).collect();
            for (&clique, blocks) in chunk.iter().zip(matrices) {
                add_cell(matrix, self.cliques.members(clique), blocks?.as_ref());
            }
        }
        Ok(true)
    }
}

/// The nodes of each cell of a mesh.
pub(in crate::model) fn nodes_of_cells(mesh: &VolumeMesh) -> Cliques {
    let mut cliques = Cliques::default();
    mesh.cells.iter().for_each(|(_, nodes)| cliques.push(nodes.iter().copied()));
    cliques
}

/// The node at one end of the longest extent.
fn far_end(nodes: &[Vector]) -> usize {
    let infinite = Vector::repeat(f64::INFINITY);
    let (low, high) =
        nodes.iter().fold((infinite, -infinite), |(low, high), x| (low.inf(x), high.sup(x)));
    let axis = (high - low).imax();
    let ends = (0..nodes.len()).min_by(|&a, &b| nodes[a][axis].total_cmp(&nodes[b][axis]));
    ends.unwrap_or_default()
}

/// What rows need of an isotropic tetrahedron: gradients of the shape functions, and lambda V and mu V.
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
        numbering: &Numbering,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
        self.assemble_with(numbering, keep_going, &|cell| self.tensor(cell))
    }

    /// The stiffness of the tissue of a cell.
    pub fn tensor(&self, cell: usize) -> ElasticTensor {
        let direction = self.fibres.get(cell).copied().unwrap_or_default();
        self.materials[self.material_of_cell[cell] as usize].tensor(&direction)
    }

    /// K with another stiffness for each cell. The membrane is part of it.
    pub(super) fn assemble_with(
        &self,
        numbering: &Numbering,
        keep_going: &dyn Fn() -> bool,
        tensor: &(dyn Fn(usize) -> ElasticTensor + Sync),
    ) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
        let mut matrix = HalfMatrix::zeros(numbering.pattern.clone());
        let order = &numbering.layout.clique_order;
        let simplex = |&cell: &u32| self.simplex(cell as usize, &tensor(cell as usize));
        let simplices: Vec<Option<Simplex>> =
            order.par_iter().map(simplex).collect::<Result<_, _>>()?;
        if !keep_going() {
            return Ok(None);
        }
        matrix.row_chunks(ROW_CHUNK).into_par_iter().for_each_init(
            || vec![0_u32; numbering.pattern.rows()],
            |at, chunk| add_rows(numbering, &simplices, chunk, at),
        );
        let others: Vec<usize> =
            (0..order.len()).filter(|&clique| simplices[clique].is_none()).collect();
        let finished = numbering.add_cells(&mut matrix, &others, keep_going, |cell| {
            self.cell_matrix(cell, &tensor(cell))
        })?;
        if let Some(membrane) = self.membrane {
            membrane.add_linear(&mut matrix, numbering, self.mesh);
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
    #[inline]
    fn add_block(&self, j: usize, k: usize, block: &mut Block) {
        add_isotropic_pair(block, [&self.gradients[j], &self.gradients[k]], self.lambda, self.mu);
    }
}

/// Row by row: no two threads write to the same block, and cells are added in their order. `at` is
/// scratch: where the block of each column of the row lies.
fn add_rows(
    numbering: &Numbering,
    simplices: &[Option<Simplex>],
    chunk: RowChunk<f64, 3>,
    at: &mut [u32],
) {
    let begin = numbering.pattern.range(chunk.first).start;
    for (local, diagonal) in chunk.diagonal.iter_mut().enumerate() {
        let row = chunk.first + local;
        let offset = numbering.pattern.range(row).start - begin;
        for (k, &column) in numbering.pattern.columns(row).iter().enumerate() {
            at[column as usize] = (offset + k) as u32;
        }
        for &clique in numbering.around.of(row) {
            let Some(simplex) = &simplices[clique as usize] else { continue };
            let members = numbering.cliques.members(clique as usize);
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

/// Adds the blocks of a cell, row by row, to the rows of its nodes.
pub(super) fn add_cell(matrix: &mut HalfMatrix<f64, 3>, rows: &[u32], blocks: &[Block]) {
    for (j, &row) in rows.iter().enumerate() {
        for (k, &column) in rows.iter().enumerate().filter(|(_, column)| **column <= row) {
            let sum = matrix.block_mut(row as usize, column as usize);
            let block = &blocks[j * rows.len() + k];
            for (sum, value) in sum.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
                *sum += value;
            }
        }
    }
}

/// The rows of held nodes that keep free unknowns.
pub fn partly_held(holds: &[Hold], numbering: &Numbering) -> Vec<PartlyHeld> {
    holds
        .iter()
        .map(|hold| (hold, numbering.row(hold.node)))
        .filter(|(hold, row)| *row < numbering.layout.free && hold.count() > 0)
        .map(|(hold, row)| PartlyHeld {
            row,
            held: std::array::from_fn(|k| k < hold.count()),
            axes: *hold.axes(),
        })
        .collect()
}

/// Writes the rows and columns of nodes with axes of their own in those axes: Q^T K Q.
pub fn turn_into_axes(matrix: &mut HalfMatrix<f64, 3>, partly_held: &[PartlyHeld]) {
    if partly_held.is_empty() {
        return;
    }
    let mut axes = vec![None; matrix.rows()];
    for partly in partly_held {
        axes[partly.row] = Some(partly.axes);
    }
    let pattern = matrix.pattern.clone();
    for row in 0..matrix.rows() {
        let turned = |block: &Block, column: usize| -> Block {
            let mut result = nalgebra::Matrix3::from_fn(|i, j| block[i][j]);
            if let Some(q) = &axes[row] {
                result = q.transpose() * result;
            }
            if let Some(q) = &axes[column] {
                result *= q;
            }
            std::array::from_fn(|i| std::array::from_fn(|j| result[(i, j)]))
        };
        if axes[row].is_some() {
            matrix.diagonal[row] = turned(&matrix.diagonal[row], row);
        }
        for (at, &column) in pattern.range(row).zip(pattern.columns(row)) {
            if axes[row].is_some() || axes[column as usize].is_some() {
                matrix.lower[at] = turned(&matrix.lower[at], column as usize);
            }
        }
    }
}
