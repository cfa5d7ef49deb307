//! A symmetric sparse matrix of 3x3 blocks, both triangles stored, rows ascending.

use rayon::prelude::*;

/// A 3x3 block, row-major.
pub type Block = [f64; 9];

/// Compressed rows of blocks; every row has its diagonal block.
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    row_start: Vec<usize>,
    columns: Vec<u32>,
    blocks: Vec<Block>,
}

/// Rows multiplied by one thread at a time; large enough to pay for the hand-over.
const ROW_CHUNK: usize = 1024;

impl BlockMatrix {
    /// A zero matrix that couples all members of each clique, such as the nodes of a cell.
    pub fn from_cliques<'a, I>(rows: usize, cliques: I) -> Self
    where
        I: Iterator<Item = &'a [u32]> + Clone,
    {
        let cliques_of_row = members_to_cliques(rows, cliques.clone());
        let cliques: Vec<&[u32]> = cliques.collect();
        let mut row_start = Vec::with_capacity(rows + 1);
        row_start.push(0);
        let mut columns = Vec::new();
        let mut last_seen = vec![u32::MAX; rows];
        for row in 0..rows {
            let begin = columns.len();
            columns.push(row as u32);
            last_seen[row] = row as u32;
            for &clique in cliques_of_row.of(row) {
                for &column in cliques[clique as usize] {
                    if last_seen[column as usize] != row as u32 {
                        last_seen[column as usize] = row as u32;
                        columns.push(column);
                    }
                }
            }
            columns[begin..].sort_unstable();
            row_start.push(columns.len());
        }
        let blocks = vec![[0.0; 9]; columns.len()];
        BlockMatrix { row_start, columns, blocks }
    }

    pub fn rows(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Memory of the matrix, of a multigrid hierarchy for it and of the vectors of the iterations, in MB.
    pub fn megabytes(&self) -> f64 {
        // 76 bytes a block here; in the hierarchy 20 for the f32 half, and about 30 for coarser levels.
        let blocks = self.columns.len() * (76 + 50);
        // Eight vectors of three unknowns, inverse diagonals, and two prolongator blocks.
        let rows = self.rows() * (8 * (1 + 3 * 8) + 36 + 2 * 76);
        (blocks + rows) as f64 / 1e6
    }

    /// The columns of a row and their blocks.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &Block)> {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.columns[range.clone()].iter().map(|&c| c as usize).zip(&self.blocks[range])
    }

    /// The columns of a row, ascending.
    pub fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.row_start[row]..self.row_start[row + 1]]
    }

    /// A block of the pattern.
    ///
    /// # Panics
    /// When the pattern does not couple the two rows.
    pub fn block_mut(&mut self, row: usize, column: usize) -> &mut Block {
        let position = self
            .columns(row)
            .binary_search(&(column as u32))
            .expect("cells only couple the nodes that the pattern was made from");
        &mut self.blocks[self.row_start[row] + position]
    }

    /// The diagonal block of a row.
    pub fn diagonal(&self, row: usize) -> &Block {
        let position = self.columns(row).binary_search(&(row as u32));
        let position = position.expect("every row was made with its diagonal");
        &self.blocks[self.row_start[row] + position]
    }

    /// `product` = K `x`.
    pub fn multiply(&self, x: &[f64], product: &mut [f64]) {
        product.par_chunks_mut(3 * ROW_CHUNK).enumerate().for_each(|(chunk, product)| {
            for (local, sums) in product.chunks_exact_mut(3).enumerate() {
                let row = chunk * ROW_CHUNK + local;
                let range = self.row_start[row]..self.row_start[row + 1];
                let mut sum = [0.0; 3];
                for (&column, block) in self.columns[range.clone()].iter().zip(&self.blocks[range])
                {
                    let x = &x[3 * column as usize..3 * column as usize + 3];
                    for (sum, row) in sum.iter_mut().zip(block.chunks_exact(3)) {
                        *sum += row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
                    }
                }
                sums.copy_from_slice(&sum);
            }
        });
    }
}

/// For each row the cliques it is a member of.
struct CliquesOfRow {
    start: Vec<usize>,
    cliques: Vec<u32>,
}

impl CliquesOfRow {
    fn of(&self, row: usize) -> &[u32] {
        &self.cliques[self.start[row]..self.start[row + 1]]
    }
}

/// A counting sort of cliques around their members.
fn members_to_cliques<'a>(
    rows: usize,
    cliques: impl Iterator<Item = &'a [u32]> + Clone,
) -> CliquesOfRow {
    let mut start = vec![0_usize; rows + 1];
    for &member in cliques.clone().flatten() {
        start[member as usize + 1] += 1;
    }
    for row in 0..rows {
        start[row + 1] += start[row];
    }
    let mut next = start.clone();
    let mut sorted = vec![0; start[rows]];
    for (clique, members) in cliques.enumerate() {
        for &member in members {
            sorted[next[member as usize]] = clique as u32;
            next[member as usize] += 1;
        }
    }
    CliquesOfRow { start, cliques: sorted }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_couples_the_members_of_each_clique_and_nothing_else() {
        let cliques: [&[u32]; 2] = [&[0, 2, 3], &[3, 1]];
        let matrix = BlockMatrix::from_cliques(5, cliques.into_iter());
        let pattern: Vec<&[u32]> = (0..5).map(|row| matrix.columns(row)).collect();
        assert_eq!(pattern, [&[0, 2, 3][..], &[1, 3], &[0, 2, 3], &[0, 1, 2, 3], &[4]]);
    }

    #[test]
    fn the_product_is_that_of_the_dense_matrix() {
        let cliques: [&[u32]; 2] = [&[0, 1], &[1, 2]];
        let mut matrix = BlockMatrix::from_cliques(3, cliques.into_iter());
        for (row, column) in [(0, 0), (0, 1), (1, 2), (2, 2)] {
            *matrix.block_mut(row, column) =
                std::array::from_fn(|k| (1 + k + row + 10 * column) as f64);
        }
        let x: Vec<f64> = (1..=9).map(f64::from).collect();
        let mut product = vec![f64::NAN; 9];
        matrix.multiply(&x, &mut product);
        let dense = |row: usize, column: usize, r: usize, c: usize| {
            let stored = matrix.row(row).find(|(j, _)| *j == column);
            stored.map_or(0.0, |(_, block)| block[3 * r + c])
        };
        for row in 0..3 {
            for r in 0..3 {
                let sum: f64 = (0..9).map(|k| dense(row, k / 3, r, k % 3) * x[k]).sum();
                assert_eq!(product[3 * row + r], sum);
            }
        }
    }
}
