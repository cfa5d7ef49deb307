//! How strongly rows are tied to each other: a scalar picture of a block matrix.

use nalgebra::Matrix3;

use crate::solver::half_matrix::HalfMatrix;
use crate::solver::layout::Layout;

/// Minus the trace of the displacement part of each block, clipped at 0, both ways round.
pub(super) struct Ties {
    starts: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f32>,
    /// The sum of the ties to rows that are held altogether.
    pub held: Vec<f32>,
}

impl Ties {
    /// Between the free rows of a matrix. `axes` are those of a row, where it has axes of its own.
    pub fn new<'a, const B: usize>(
        matrix: &HalfMatrix<f64, B>,
        layout: &Layout,
        axes: impl Fn(usize) -> Option<&'a Matrix3<f64>>,
    ) -> Self {
        let free = layout.free;
        let mut starts = vec![0_u32; free + 1];
        for row in 0..free {
            starts[row + 1] += matrix.pattern.columns(row).len() as u32;
            for &column in matrix.pattern.columns(row) {
                starts[column as usize + 1] += 1;
            }
        }
        for row in 0..free {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut ties = Ties {
            columns: vec![0; starts[free] as usize],
            values: vec![0.0; starts[free] as usize],
            held: vec![0.0; free],
            starts,
        };
        for row in 0..matrix.rows() {
            for (column, block) in matrix.lower_row(row) {
                let tie = (-trace(block, axes(row), axes(column))).max(0.0) as f32;
                if row < free {
                    ties.put(&mut next, row, column, tie);
                    ties.put(&mut next, column, row, tie);
                } else if column < free {
                    ties.held[column] += tie;
                }
            }
        }
        ties
    }

    fn put(&mut self, next: &mut [u32], row: usize, column: usize, tie: f32) {
        let at = next[row] as usize;
        next[row] += 1;
        self.columns[at] = column as u32;
        self.values[at] = tie;
    }

    pub fn rows(&self) -> usize {
        self.held.len()
    }

    pub fn of(&self, row: usize) -> impl Iterator<Item = (usize, f32)> {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        self.columns[range.clone()]
            .iter()
            .map(|&c| c as usize)
            .zip(self.values[range].iter().copied())
    }
}

/// The trace of the displacement part of a block, in the axes of the coordinates.
fn trace<const B: usize>(
    block: &[[f64; B]; B],
    row_axes: Option<&Matrix3<f64>>,
    column_axes: Option<&Matrix3<f64>>,
) -> f64 {
    if row_axes.is_none() && column_axes.is_none() {
        return block[0][0] + block[1][1] + block[2][2];
    }
    let own = Matrix3::identity();
    let block = Matrix3::from_fn(|i, j| block[i][j]);
    let (row_axes, column_axes) = (row_axes.unwrap_or(&own), column_axes.unwrap_or(&own));
    (row_axes * block * column_axes.transpose()).trace()
}
