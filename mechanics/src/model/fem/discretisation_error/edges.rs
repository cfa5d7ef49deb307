//! Edges of cells, numbered by their places in the pattern of the matrix.

use rayon::prelude::*;

use super::edge_functions::MAX_EDGES;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::dofs::Numbering;
use crate::model::problem::InvertedCell;

/// Cells computed side by side before they are added in their order, which keeps the bits independent of the number
/// of threads.
const CHUNK: usize = 512;

/// An edge couples its two ends in the pattern: its place among the blocks below the diagonal is its number.
pub(super) struct Edges<'a> {
    mesh: &'a VolumeMesh,
    numbering: &'a Numbering,
}

/// The numbers of the edges of a cell, in the order of its shape.
#[derive(Clone, Copy)]
pub(super) struct CellEdges {
    numbers: [usize; MAX_EDGES],
    count: usize,
}

impl<'a> Edges<'a> {
    pub fn new(mesh: &'a VolumeMesh, numbering: &'a Numbering) -> Self {
        Edges { mesh, numbering }
    }

    /// Above every number of an edge; pairs of nodes that no edge joins have numbers too.
    pub fn count(&self) -> usize {
        self.numbering.pattern.len()
    }

    pub fn shape(&self, cell: usize) -> CellShape {
        self.mesh.cells.shape(cell)
    }

    /// The number of the edge between two nodes of a cell.
    pub fn between(&self, a: u32, b: u32) -> Option<usize> {
        self.of_rows(self.numbering.row(a), self.numbering.row(b))
    }

    fn of_rows(&self, a: usize, b: usize) -> Option<usize> {
        let (row, column) = (a.max(b), a.min(b));
        let at = self.numbering.pattern.columns(row).binary_search(&(column as u32)).ok()?;
        Some(self.numbering.pattern.range(row).start + at)
    }

    pub fn of_cell(&self, cell: usize) -> CellEdges {
        let nodes = self.mesh.cells.nodes(cell);
        let mut edges = CellEdges { numbers: [0; MAX_EDGES], count: 0 };
        for &[i, j] in self.shape(cell).edges() {
            // Two nodes of one cell are always coupled.
            edges.numbers[edges.count] = self.between(nodes[i], nodes[j]).unwrap_or_default();
            edges.count += 1;
        }
        edges
    }

    /// Computes something of every cell on all threads, and adds it up in the order of the layout.
    pub fn each_cell<T: Send>(
        &self,
        compute: impl Fn(usize) -> Result<T, InvertedCell> + Sync,
        mut add: impl FnMut(usize, T),
    ) -> Result<(), InvertedCell> {
        for chunk in self.numbering.layout.clique_order.chunks(CHUNK) {
            let computed: Vec<Result<T, InvertedCell>> =
                chunk.par_iter().map(|&cell| compute(cell as usize)).collect();
            for (&cell, computed) in chunk.iter().zip(computed) {
                add(cell as usize, computed?);
            }
        }
        Ok(())
    }
}

impl CellEdges {
    pub fn numbers(&self) -> &[usize] {
        &self.numbers[..self.count]
    }

    /// The values of these edges among those of all.
    pub fn gather(&self, of_edge: &[Vector]) -> [Vector; MAX_EDGES] {
        let mut own = [Vector::zeros(); MAX_EDGES];
        own.iter_mut().zip(self.numbers()).for_each(|(own, &edge)| *own = of_edge[edge]);
        own
    }
}
