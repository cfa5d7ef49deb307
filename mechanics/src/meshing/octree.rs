//! An octree whose neighbouring leaves differ by one level at most, over faces, edges and corners.

use super::grid::{Coordinates, Grid};
use crate::domain::Coverage;

/// Stands for no cell.
pub(super) const NONE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
pub(super) struct OctreeCell {
    /// The corner with the lowest coordinates.
    pub corner: Coordinates,
    pub level: u8,
    /// What the cell holds, as far as known.
    pub held: Coverage,
    /// The first of eight children, or [`NONE`].
    pub first_child: u32,
}

/// A cell that is not divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub corner: Coordinates,
    pub level: u8,
    /// Its edge in units.
    pub size: u32,
    pub held: Coverage,
}

pub(super) struct Octree {
    pub grid: Grid,
    pub cells: Vec<OctreeCell>,
    /// The cells of each level in the order in which they were made.
    pub levels: Vec<Vec<u32>>,
}

/// The leaves of an octree along a space-filling curve, and which of them holds a place.
pub(super) struct Leaves {
    pub tree: Octree,
    pub list: Vec<Leaf>,
    /// For each cell of the tree its place in the list, or [`NONE`].
    of_cell: Vec<u32>,
}

impl Octree {
    /// The cells at the top.
    pub fn new(grid: Grid) -> Octree {
        let [nx, ny, nz] = grid.roots;
        let size = grid.cell_units(0);
        let mut cells = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let corner = [x * size, y * size, z * size];
                    cells.push(OctreeCell {
                        corner,
                        level: 0,
                        held: Coverage::Mixed,
                        first_child: NONE,
                    });
                }
            }
        }
        let mut levels = vec![Vec::new(); usize::from(grid.depth) + 1];
        levels[0] = (0..cells.len() as u32).collect();
        Octree { grid, cells, levels }
    }

    /// Gives a cell eight children.
    pub fn split(&mut self, cell: u32) {
        let OctreeCell { corner: [x, y, z], level, held, .. } = self.cells[cell as usize];
        let first_child = self.cells.len() as u32;
        self.cells[cell as usize].first_child = first_child;
        let half = self.grid.cell_units(level + 1);
        for child in 0..8 {
            let corner =
                [x + (child & 1) * half, y + (child >> 1 & 1) * half, z + (child >> 2) * half];
            self.cells.push(OctreeCell { corner, level: level + 1, held, first_child: NONE });
            self.levels[usize::from(level) + 1].push(first_child + child);
        }
    }

    /// Divides cells until leaves that touch differ by one level at most.
    pub fn balance(&mut self) {
        for level in (1..self.grid.depth).rev() {
            for index in 0..self.levels[usize::from(level)].len() {
                let cell = self.cells[self.levels[usize::from(level)][index] as usize];
                if cell.first_child != NONE {
                    self.surround(&cell);
                }
            }
        }
    }

    /// Makes the 26 neighbours of a cell at its own level.
    fn surround(&mut self, cell: &OctreeCell) {
        let size = self.grid.cell_units(cell.level);
        for step in 0..27_u32 {
            let steps = [step % 3, step / 3 % 3, step / 9];
            let at =
                [0, 1, 2].map(|axis| (cell.corner[axis] + steps[axis] * size).wrapping_sub(size));
            if let Some(mut found) = self.root_at(at) {
                while self.cells[found as usize].level < cell.level {
                    if self.cells[found as usize].first_child == NONE {
                        self.split(found);
                    }
                    found = self.child_at(found, at);
                }
            }
        }
    }

    /// The cell at the top that holds a place; places below 0 have wrapped to the far end.
    fn root_at(&self, at: Coordinates) -> Option<u32> {
        let size = self.grid.cell_units(0);
        let [x, y, z] = at.map(|coordinate| coordinate / size);
        let [nx, ny, nz] = self.grid.roots;
        (x < nx && y < ny && z < nz).then(|| (z * ny + y) * nx + x)
    }

    fn child_at(&self, cell: u32, at: Coordinates) -> u32 {
        let OctreeCell { corner, level, first_child, .. } = self.cells[cell as usize];
        let half = self.grid.cell_units(level + 1);
        let high = |axis: usize| u32::from(at[axis] >= corner[axis] + half);
        first_child + high(0) + 2 * high(1) + 4 * high(2)
    }

    /// The leaves, with children in place of their parents.
    pub fn into_leaves(self) -> Leaves {
        let mut of_cell = vec![NONE; self.cells.len()];
        let mut list = Vec::with_capacity(self.cells.len());
        let mut waiting: Vec<u32> = self.levels[0].iter().rev().copied().collect();
        while let Some(id) = waiting.pop() {
            let OctreeCell { corner, level, held, first_child } = self.cells[id as usize];
            if first_child == NONE {
                of_cell[id as usize] = list.len() as u32;
                list.push(Leaf { corner, level, size: self.grid.cell_units(level), held });
            } else {
                waiting.extend((first_child..first_child + 8).rev());
            }
        }
        Leaves { tree: self, list, of_cell }
    }
}

impl Leaves {
    /// The leaf that holds a place, if it lies in the octree; a place between two cells belongs to the higher one.
    pub fn at(&self, at: Coordinates) -> Option<u32> {
        let mut cell = self.tree.root_at(at)?;
        while self.tree.cells[cell as usize].first_child != NONE {
            cell = self.tree.child_at(cell, at);
        }
        Some(self.of_cell[cell as usize])
    }

    /// Adds the leaves that a box touches, by its lowest and its highest corner in units from the origin, to a list.
    pub fn add_in_box(&self, low: Coordinates, high: Coordinates, list: &mut Vec<u32>) {
        let size = self.tree.grid.cell_units(0);
        let roots = self.tree.grid.roots;
        let along = |axis: usize| low[axis] / size..=(high[axis] / size).min(roots[axis] - 1);
        for z in along(2) {
            for y in along(1) {
                for x in along(0) {
                    self.add_below((z * roots[1] + y) * roots[0] + x, low, high, list);
                }
            }
        }
    }

    fn add_below(&self, cell: u32, low: Coordinates, high: Coordinates, list: &mut Vec<u32>) {
        let OctreeCell { corner, level, first_child, .. } = self.tree.cells[cell as usize];
        if first_child == NONE {
            list.push(self.of_cell[cell as usize]);
            return;
        }
        let half = self.tree.grid.cell_units(level + 1);
        let reached = [0, 1, 2].map(|axis| {
            let middle = corner[axis] + half;
            [low[axis] <= middle, high[axis] >= middle]
        });
        for child in 0..8 {
            if (0..3).all(|axis| reached[axis][child >> axis & 1]) {
                self.add_below(first_child + child as u32, low, high, list);
            }
        }
    }
}
