//! Edges of cells, numbered by their places in the pattern of the matrix.

use rayon::prelude::*;

use super::edge_functions::MAX_EDGES;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::DofMap;
use crate::model::problem::InvertedCell;

/// Cells computed side by side before they are added in their order, which keeps the bits independent of the number
/// of threads.
const CHUNK: usize = 512;

/// An edge couples its two ends in the pattern: its place among the blocks below the diagonal is its number.
pub(super) struct Edges<'a> {
    mesh: &'a VolumeMesh,
    dof_map: &'a DofMap,
    /// Of each cell, in the order of the layout.
    of_cells: Vec<CellEdges>,
}

/// The numbers of the edges of a cell, in the order of its shape.
#[derive(Clone, Copy)]
pub(super) struct CellEdges {
    numbers: [u32; MAX_EDGES],
    count: u32,
}

impl<'a> Edges<'a> {
    pub fn new(mesh: &'a VolumeMesh, dof_map: &'a DofMap) -> Self {
        let mut edges = Edges { mesh, dof_map, of_cells: Vec::new() };
        let order = dof_map.ordering.element_order.par_iter();
        edges.of_cells = order.map(|&cell| edges.of_cell(cell as usize)).collect();
        edges
    }

    /// Above every number of an edge; pairs of nodes that no edge joins have numbers too.
    pub fn count(&self) -> usize {
        self.dof_map.pattern.len()
    }

    /// The number of the edge between two nodes of a cell.
    pub fn between(&self, a: u32, b: u32) -> Option<usize> {
        self.of_rows(self.dof_map.row(a), self.dof_map.row(b))
    }

    fn of_rows(&self, a: usize, b: usize) -> Option<usize> {
        let (row, column) = (a.max(b), a.min(b));
        let at = self.dof_map.pattern.columns(row).binary_search(&(column as u32)).ok()?;
        Some(self.dof_map.pattern.range(row).start + at)
    }

    pub fn of_cell(&self, cell: usize) -> CellEdges {
        let nodes = self.mesh.cells.nodes(cell);
        let pairs = self.mesh.cells.shape(cell).edges();
        let mut edges = CellEdges { numbers: [0; MAX_EDGES], count: pairs.len() as u32 };
        for (number, &[i, j]) in edges.numbers.iter_mut().zip(pairs) {
            // Two nodes of one cell are always coupled.
            *number = self.between(nodes[i], nodes[j]).unwrap_or_default() as u32;
        }
        edges
    }

    /// Computes something of every cell on all threads, in place of `blank` or of what another cell left there, and adds it up
    /// in the order of the layout.
    pub fn each_cell<T: Clone + Send>(
        &self,
        blank: T,
        compute: impl Fn(usize, &CellEdges, &mut T) -> Result<(), InvertedCell> + Sync,
        mut add: impl FnMut(usize, &CellEdges, &T),
    ) -> Result<(), InvertedCell> {
        let order = &self.dof_map.ordering.element_order;
        let mut room = vec![blank; CHUNK.min(order.len())];
        for (cells, of_cells) in order.chunks(CHUNK).zip(self.of_cells.chunks(CHUNK)) {
            let places = room.par_iter_mut().zip(cells).zip(of_cells);
            places.try_for_each(|((place, &cell), edges)| compute(cell as usize, edges, place))?;
            for ((place, &cell), edges) in room.iter().zip(cells).zip(of_cells) {
                add(cell as usize, edges, place);
            }
        }
        Ok(())
    }
}

impl CellEdges {
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        self.numbers[..self.count as usize].iter().map(|&edge| edge as usize)
    }

    /// The values of these edges among those of all.
    pub fn gather(&self, of_edge: &[Vector]) -> [Vector; MAX_EDGES] {
        let mut own = [Vector::zeros(); MAX_EDGES];
        own.iter_mut().zip(self.numbers()).for_each(|(own, edge)| *own = of_edge[edge]);
        own
    }
}
