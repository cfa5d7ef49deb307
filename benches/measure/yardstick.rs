//! What the machine can do: bandwidth of the triad, and one f64 product with 3x3 blocks in plain storage.
//!
//! Triad: a_i = b_i + s c_i (McCalpin, STREAM), 24 bytes an element. Product: y = K x with every block of
//! the free nodes stored, 76 bytes a block. The product keeps this form whatever the solver stores, so that
//! "products" mean the same from one version to the next.

use mechanics::mesh::VolumeMesh;
use rayon::prelude::*;

use super::{on_threads, seconds};

/// 128 MB an array, so that three of them are far larger than the last level of cache.
const TRIAD_LENGTH: usize = 16 << 20;

/// Rows that one thread multiplies at a time.
const CHUNK: usize = 1024;

/// GB/s on that many threads, the best of several passes as STREAM does.
pub fn triad_gb_per_s(threads: usize) -> f64 {
    let mut a = vec![0.0_f64; TRIAD_LENGTH];
    let (b, c) = (vec![1.0_f64; TRIAD_LENGTH], vec![2.0_f64; TRIAD_LENGTH]);
    let share = TRIAD_LENGTH / threads;
    let best = on_threads(threads, || {
        let pass = |_| {
            seconds(1, || {
                a.par_chunks_mut(share).zip(b.par_chunks(share).zip(c.par_chunks(share))).for_each(
                    |(a, (b, c))| {
                        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                            *a = b + 3.0 * c;
                        }
                    },
                );
            })
        };
        (0..5).map(pass).fold(f64::INFINITY, f64::min)
    });
    24.0 * TRIAD_LENGTH as f64 / best / 1e9
}

/// Every block of the free rows and columns of a mesh, in the order of its nodes.
pub struct PlainBlocks {
    start: Vec<usize>,
    columns: Vec<u32>,
    blocks: Vec<[f64; 9]>,
}

impl PlainBlocks {
    /// The pattern of the mesh; the values are of no consequence for the time.
    pub fn new(mesh: &VolumeMesh, is_free: impl Fn(usize) -> bool) -> Self {
        let mut number = vec![u32::MAX; mesh.nodes.len()];
        let free = (0..mesh.nodes.len()).filter(|&node| is_free(node));
        let rows = free.zip(0..).map(|(node, row)| number[node] = row).count();
        let mut pairs: Vec<Vec<u32>> = vec![Vec::new(); rows];
        for (_, nodes) in mesh.cells.iter() {
            let members: Vec<u32> = nodes.iter().map(|&node| number[node as usize]).collect();
            let members: Vec<u32> = members.into_iter().filter(|&row| row != u32::MAX).collect();
            members.iter().for_each(|&row| pairs[row as usize].extend_from_slice(&members));
        }
        let (mut start, mut columns) = (vec![0], Vec::new());
        for mut row in pairs {
            row.sort_unstable();
            row.dedup();
            columns.extend(row);
            start.push(columns.len());
        }
        let blocks = (0..columns.len()).map(|k| [1.0 / (1 + k) as f64; 9]).collect();
        PlainBlocks { start, columns, blocks }
    }

    /// Bytes read and written by one product, vectors counted once.
    pub fn bytes(&self) -> f64 {
        (self.columns.len() * 76 + (self.start.len() - 1) * (8 + 48)) as f64
    }

    /// Median seconds of one product on that many threads.
    pub fn seconds(&self, threads: usize) -> f64 {
        let x = vec![[1.0; 3]; self.start.len() - 1];
        let mut product = vec![[0.0; 3]; x.len()];
        on_threads(threads, || seconds(20, || self.multiply(&x, &mut product)))
    }

    fn multiply(&self, x: &[[f64; 3]], product: &mut [[f64; 3]]) {
        product.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, product)| {
            for (sum, row) in product.iter_mut().zip(chunk * CHUNK..) {
                let range = self.start[row]..self.start[row + 1];
                *sum = [0.0; 3];
                for (&column, block) in self.columns[range.clone()].iter().zip(&self.blocks[range])
                {
                    let x = &x[column as usize];
                    for r in 0..3 {
                        sum[r] +=
                            block[3 * r] * x[0] + block[3 * r + 1] * x[1] + block[3 * r + 2] * x[2];
                    }
                }
            }
        });
    }
}
