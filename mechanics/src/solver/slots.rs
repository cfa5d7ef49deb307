//! Positions of the terms of a sparse matrix that is assembled repeatedly over the same cells.

use rayon::prelude::*;

use super::element_connectivity::ElementConnectivity;
use super::sparse_rows::{Couplings, Entry, SparseRows};
use crate::rows::Rows;

/// Rows that one thread fills at a time.
const ROW_CHUNK: usize = 1024;

/// What a cell adds to one row: the row is its corner `corner`, its columns are the entries `slots` of the row.
#[derive(Clone, Copy, Debug)]
struct Part {
    cell: u32,
    corner: u8,
    slots: [u16; 4],
}

/// For each row the cells around it, in their order.
pub struct Slots(Rows<Part>);

impl Slots {
    /// For a matrix that `SparseRows::assemble` made of these couplings.
    pub fn new<T: Entry>(matrix: &SparseRows<T>, couplings: &Couplings) -> Self {
        let mut connectivity = ElementConnectivity::default();
        couplings.rows.iter().for_each(|rows| connectivity.push(*rows));
        let around = connectivity.inverted(matrix.rows());
        let part = |row: usize, cell: u32| {
            let of_cell = &couplings.rows[cell as usize];
            let corner = of_cell.iter().position(|&named| named as usize == row);
            let slots = couplings.columns[cell as usize].map(|column| matrix.slot(row, column));
            Part { cell, corner: corner.unwrap_or_default() as u8, slots }
        };
        let mut parts = Rows::with_room(matrix.rows(), around.entries().len());
        for row in 0..matrix.rows() {
            parts.push(around.row(row).iter().map(|&cell| part(row, cell)));
        }
        Slots(parts)
    }

    /// The sum of 4 x 4 cell matrices in place of what the matrix held; `value(cell, row, column)` with local numbers.
    pub fn fill<T: Entry + Default>(
        &self,
        matrix: &mut SparseRows<T>,
        value: impl Fn(usize, usize, usize) -> T + Sync,
    ) {
        matrix.row_chunks(ROW_CHUNK).into_par_iter().for_each(|chunk| {
            chunk.values.fill(T::default());
            for (row, begin) in chunk.rows.zip(chunk.begins) {
                for part in self.0.row(row) {
                    for (column, &slot) in part.slots.iter().enumerate() {
                        let term = value(part.cell as usize, usize::from(part.corner), column);
                        chunk.values[begin + usize::from(slot)].add(term);
                    }
                }
            }
        });
    }
}
