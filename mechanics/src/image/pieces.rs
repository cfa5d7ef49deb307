//! The connected pieces of a mask.
//!
//! Rows of the image are cut into runs, and runs that touch are joined (union-find): memory for the runs, not for the
//! voxels, until the labels are written.

use std::ops::Range;

use super::mask::Mask;
use crate::mesh::disjoint_sets::DisjointSets;

/// Which voxels hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connection {
    /// Those that share a face: 6 neighbours.
    Faces,
    /// Those that share a corner: 26 neighbours.
    Corners,
}

/// Every piece, numbered from 0 in the order of its first voxel.
#[derive(Clone, Debug, PartialEq)]
pub struct Pieces {
    /// For each voxel the number of its piece plus one; 0 outside the mask.
    labels: Vec<u32>,
    /// In voxels.
    pub sizes: Vec<u64>,
}

/// Neighbouring voxels of a row: from the first up to before the end.
#[derive(Clone, Copy)]
struct Run {
    start: usize,
    end: usize,
}

impl Pieces {
    pub fn of(mask: &Mask, connection: Connection) -> Pieces {
        let [length, rows, slices] = mask.grid.size;
        let (runs, first_of_row) = runs(mask);
        let mut sets = DisjointSets::new(runs.len());
        let reach = usize::from(connection == Connection::Corners);
        for row in 0..rows * slices {
            let (j, k) = (row % rows, row / rows);
            let here = first_of_row[row]..first_of_row[row + 1];
            for other in rows_before(connection).iter().filter_map(|by| by.of(j, k, rows)) {
                let there = first_of_row[other]..first_of_row[other + 1];
                let rows = RowPair { here: here.clone(), there, shift: (row - other) * length };
                rows.join(&runs, reach, &mut sets);
            }
        }
        numbered(mask, &runs, &mut sets)
    }

    /// The piece of a voxel.
    pub fn piece(&self, voxel: usize) -> Option<usize> {
        (self.labels[voxel] as usize).checked_sub(1)
    }

    /// The piece of the most voxels, the first of those that have as many.
    pub fn largest(&self) -> Option<usize> {
        let most = self.sizes.iter().max()?;
        self.sizes.iter().position(|size| size == most)
    }

    /// The pieces that a rule takes.
    pub fn mask(&self, like: &Mask, takes: impl Fn(usize) -> bool) -> Mask {
        let taken: Vec<bool> = (0..self.sizes.len()).map(takes).collect();
        let inside = |&label: &u32| label > 0 && taken[label as usize - 1];
        Mask { grid: like.grid, inside: self.labels.iter().map(inside).collect() }
    }

    /// The largest piece alone; nothing of an empty mask.
    pub fn largest_mask(&self, like: &Mask) -> Mask {
        let largest = self.largest();
        self.mask(like, |piece| Some(piece) == largest)
    }
}

/// A row that comes before another: so far back along the second axis, and along the third.
struct RowBefore {
    back: isize,
    below: usize,
}

impl RowBefore {
    fn of(&self, j: usize, k: usize, rows: usize) -> Option<usize> {
        let j = j.checked_add_signed(-self.back).filter(|&j| j < rows)?;
        Some(j + rows * k.checked_sub(self.below)?)
    }
}

fn rows_before(connection: Connection) -> &'static [RowBefore] {
    const ALL: [RowBefore; 4] = [
        RowBefore { back: 1, below: 0 },
        RowBefore { back: 0, below: 1 },
        RowBefore { back: 1, below: 1 },
        RowBefore { back: -1, below: 1 },
    ];
    match connection {
        Connection::Faces => &ALL[..2],
        Connection::Corners => &ALL,
    }
}

/// All runs, and the number of the first of each row.
fn runs(mask: &Mask) -> (Vec<Run>, Vec<usize>) {
    let length = mask.grid.size[0];
    let mut runs: Vec<Run> = Vec::new();
    let mut first_of_row = Vec::with_capacity(mask.inside.len() / length + 1);
    for (row, inside) in mask.inside.chunks(length).enumerate() {
        first_of_row.push(runs.len());
        let mut was_inside = false;
        for (place, &is_inside) in inside.iter().enumerate() {
            let at = row * length + place;
            match (was_inside, is_inside, runs.last_mut()) {
                (false, true, _) => runs.push(Run { start: at, end: at + 1 }),
                (true, true, Some(run)) => run.end = at + 1,
                _ => {}
            }
            was_inside = is_inside;
        }
    }
    first_of_row.push(runs.len());
    (runs, first_of_row)
}

/// The runs of two rows, and how far the second row is behind the first.
struct RowPair {
    here: Range<usize>,
    there: Range<usize>,
    shift: usize,
}

impl RowPair {
    /// Joins those that overlap, or that are next to each other where corners count.
    fn join(self, runs: &[Run], reach: usize, sets: &mut DisjointSets) {
        let (mut one, mut other) = (self.here.start, self.there.start);
        while one < self.here.end && other < self.there.end {
            let (a, b) = (runs[one], runs[other]);
            let b = Run { start: b.start + self.shift, end: b.end + self.shift };
            if a.start < b.end + reach && b.start < a.end + reach {
                sets.join(one as u32, other as u32);
            }
            if a.end < b.end { one += 1 } else { other += 1 }
        }
    }
}

fn numbered(mask: &Mask, runs: &[Run], sets: &mut DisjointSets) -> Pieces {
    let mut labels = vec![0; mask.inside.len()];
    let mut of_set = vec![0_u32; runs.len()];
    let mut sizes = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let label = &mut of_set[sets.root(number as u32) as usize];
        if *label == 0 {
            sizes.push(0);
            *label = sizes.len() as u32;
        }
        sizes[*label as usize - 1] += (run.end - run.start) as u64;
        labels[run.start..run.end].fill(*label);
    }
    Pieces { labels, sizes }
}
