//! Strength of connection between rows: one scalar for each block of a matrix.

use nalgebra::Matrix3;

use crate::rows::{Rows, Sorting};
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::row_ordering::RowOrdering;

/// Minus the trace of the displacement part of each block, clipped at 0, both ways round.
pub(super) struct StrengthOfConnection {
    /// The columns of each row, and how strongly each is tied to it.
    rows: Rows<(u32, f32)>,
    /// The summed strength of connection to fully constrained rows.
    pub held: Vec<f32>,
}

impl StrengthOfConnection {
    /// Between the free rows of a matrix. `axes` are those of a row, where it has axes of its own.
    pub fn new<'a, const B: usize>(
        matrix: &HalfMatrix<f64, B>,
        ordering: &RowOrdering,
        axes: impl Fn(usize) -> Option<&'a Matrix3<f64>>,
    ) -> Self {
        let free = ordering.free;
        let mut lengths = vec![0_u32; free];
        for row in 0..free {
            lengths[row] += matrix.pattern.columns(row).len() as u32;
            for &column in matrix.pattern.columns(row) {
                lengths[column as usize] += 1;
            }
        }
        let mut sorting = Sorting::new(&lengths, (0, 0.0));
        let mut held = vec![0.0; free];
        for row in 0..matrix.rows() {
            for (column, block) in matrix.lower_row(row) {
                let tie = (-trace(block, axes(row), axes(column))).max(0.0) as f32;
                if row < free {
                    sorting.put(row, (column as u32, tie));
                    sorting.put(column, (row as u32, tie));
                } else if column < free {
                    held[column] += tie;
                }
            }
        }
        StrengthOfConnection { rows: sorting.finish(), held }
    }

    pub fn rows(&self) -> usize {
        self.held.len()
    }

    pub fn of(&self, row: usize) -> impl Iterator<Item = (usize, f32)> {
        self.rows.row(row).iter().map(|&(column, tie)| (column as usize, tie))
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
