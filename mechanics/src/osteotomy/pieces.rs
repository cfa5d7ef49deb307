//! Pieces of bone: voxels that hang together at faces.

use super::grid::Grid;
use super::rule::Osteotomy;
use crate::mesh::Vector;

/// Pieces of bone together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PieceSummary {
    pub pieces: usize,
    pub voxels: usize,
    pub largest_voxels: usize,
    /// In mm.
    pub largest_centre: Vector,
}

/// The pieces of bone that a segment may have, face by face connected.
pub(super) struct Pieces {
    /// For each voxel one more than the number of its piece; 0 where there is none.
    of: Vec<u32>,
    count: u32,
}

impl Pieces {
    /// The pieces of the voxels that count, without what bounded cuts part.
    pub fn new(osteotomy: &Osteotomy, grid: &Grid<'_>, counts: impl Fn(usize) -> bool) -> Pieces {
        let mut of = vec![0; grid.len()];
        let mut count = 0;
        let mut waiting = Vec::new();
        for first in 0..grid.len() {
            if of[first] != 0 || !counts(first) {
                continue;
            }
            count += 1;
            of[first] = count;
            waiting.push(first);
            while let Some(voxel) = waiting.pop() {
                let centre = grid.centre(voxel);
                for next in grid.neighbours(voxel).map(|neighbour| neighbour.voxel) {
                    if of[next] == 0
                        && counts(next)
                        && !osteotomy.severs(&centre, &grid.centre(next))
                    {
                        of[next] = count;
                        waiting.push(next);
                    }
                }
            }
        }
        Pieces { of, count }
    }

    /// How many voxels each piece has.
    fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.count as usize];
        for &piece in self.of.iter().filter(|piece| **piece > 0) {
            sizes[piece as usize - 1] += 1;
        }
        sizes
    }

    /// The pieces with fewer voxels.
    pub fn smaller_than(mut self, least: usize) -> Pieces {
        let sizes = self.sizes();
        let mut number_of = vec![0; sizes.len() + 1];
        self.count = 0;
        for (piece, _) in sizes.iter().enumerate().filter(|(_, size)| **size < least) {
            self.count += 1;
            number_of[piece + 1] = self.count;
        }
        self.of.iter_mut().for_each(|piece| *piece = number_of[*piece as usize]);
        self
    }

    pub fn voxels(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.of.len()).filter(|&voxel| self.of[voxel] > 0)
    }

    /// The voxels of the largest piece, of the first one where several are as large.
    pub fn largest(&self) -> Vec<usize> {
        let sizes = self.sizes();
        let most = sizes.iter().copied().max().unwrap_or(0);
        let Some(largest) = sizes.iter().position(|&size| size == most) else { return Vec::new() };
        (0..self.of.len()).filter(|&voxel| self.of[voxel] as usize == largest + 1).collect()
    }

    pub fn summary(&self, grid: &Grid<'_>) -> PieceSummary {
        let largest = self.largest();
        let sum = largest.iter().fold(Vector::zeros(), |sum, &voxel| sum + grid.centre(voxel));
        PieceSummary {
            pieces: self.count as usize,
            voxels: self.sizes().iter().sum(),
            largest_voxels: largest.len(),
            largest_centre: sum / largest.len().max(1) as f64,
        }
    }
}
