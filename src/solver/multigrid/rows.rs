//! Symmetric block matrices as a hierarchy reads them: row by row, whole.

use super::super::LinearSystem;

/// A B x B block.
pub(super) type Dense<const B: usize> = [[f64; B]; B];

/// Rows of blocks, columns ascending.
pub(super) trait BlockRows<const B: usize>: Sync {
    fn rows(&self) -> usize;

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, Dense<B>)>;

    /// How strongly a row is tied to each other one: minus the trace of the displacement part of their
    /// block, clipped at 0.
    fn ties(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        self.row(row)
            .filter(move |(column, _)| *column != row)
            .map(|(column, block)| (column, (-(block[0][0] + block[1][1] + block[2][2])).max(0.0)))
    }
}

/// The finest level: rows and columns of held unknowns are zero.
impl BlockRows<3> for LinearSystem<'_> {
    fn rows(&self) -> usize {
        self.matrix.rows()
    }

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, Dense<3>)> {
        let row_held = &self.held[3 * row..3 * row + 3];
        self.matrix.row(row).map(move |(column, block)| {
            let column_held = &self.held[3 * column..3 * column + 3];
            let entry = |i: usize, j: usize| match row_held[i] || column_held[j] {
                true => 0.0,
                false => block[3 * i + j],
            };
            (column, std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
        })
    }
}

/// A coarse level: six movements of each aggregate.
pub(super) struct CoarseMatrix {
    pub row_start: Vec<usize>,
    pub columns: Vec<u32>,
    pub blocks: Vec<Dense<6>>,
}

impl BlockRows<6> for CoarseMatrix {
    fn rows(&self) -> usize {
        self.row_start.len() - 1
    }

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, Dense<6>)> {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.columns[range.clone()]
            .iter()
            .map(|&c| c as usize)
            .zip(self.blocks[range].iter().copied())
    }
}
