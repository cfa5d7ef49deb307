//! Refinement of the octree to the size field where there may be tissue.

use super::error::MeshingError;
use super::grid::Grid;
use super::missed::misses_tissue;
use super::octree::{Leaves, NONE, Octree, OctreeCell};
use super::size::SizeField;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;

/// Tetrahedra of a cube in the inside of a body-centred cubic lattice.
pub(super) const PER_CUBE: f64 = 12.0;
/// Half the diagonal of a cube of edge 1.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;

/// A body and the sizes asked for.
pub(super) struct Refinement<'a> {
    pub domain: &'a dyn Domain,
    pub size: &'a SizeField,
    /// More tetrahedra are refused.
    pub most: usize,
    /// Halves cells that would miss thin tissue, down to the finest.
    pub keeps_thin: bool,
}

/// What is known of a cell once it has been looked at.
struct Visit {
    held: Coverage,
    splits: bool,
    /// The size asked for at the cell, in mm.
    wanted: f64,
}

impl Refinement<'_> {
    /// The balanced octree of a grid.
    pub fn leaves(&self, grid: Grid, watch: &Watch) -> Result<Leaves, MeshingError> {
        let mut tree = Octree::new(grid);
        let mut done = 0.0;
        for level in 0..=tree.grid.depth {
            let looked_at = tree.levels[usize::from(level)].clone();
            let visits =
                watch.map(&looked_at, |&cell| self.visit(&tree, &tree.cells[cell as usize]))?;
            done += self.refuse_too_many(&tree.grid, level, &visits, done)?;
            for (&cell, visit) in looked_at.iter().zip(&visits) {
                tree.cells[cell as usize].held = visit.held;
                if visit.splits {
                    tree.split(cell);
                }
            }
        }
        tree.balance();
        watch.check_cancelled()?;
        let leaves = tree.into_leaves();
        let tissue = leaves.list.iter().map(|leaf| share(leaf.held) * PER_CUBE);
        self.refuse(tissue.sum())?;
        Ok(leaves)
    }

    /// Tetrahedra in the leaves of a level; refuses where these and those to come are too many for certain.
    fn refuse_too_many(
        &self,
        grid: &Grid,
        level: u8,
        visits: &[Visit],
        done: f64,
    ) -> Result<f64, MeshingError> {
        let size = edge(grid, level);
        let leaves = visits.iter().filter(|visit| !visit.splits);
        let here: f64 = leaves.map(|visit| share(visit.held) * PER_CUBE).sum();
        let coming = visits.iter().filter(|visit| visit.splits).map(|visit| {
            let cells = (size / visit.wanted).max(1.0);
            match visit.held {
                Coverage::Inside => cells.powi(3),
                // A surface through the cell, at least.
                Coverage::Mixed => 0.25 * cells.powi(2),
                Coverage::Outside => 0.0,
            }
        });
        self.refuse(done + here + PER_CUBE * coming.sum::<f64>())?;
        Ok(here)
    }

    fn refuse(&self, estimated: f64) -> Result<(), MeshingError> {
        if estimated > self.most as f64 {
            let (estimated, allowed) = (estimated as u64, self.most as u64);
            return Err(MeshingError::TooMany { estimated, allowed, finest: self.size.finest });
        }
        Ok(())
    }

    fn visit(&self, tree: &Octree, cell: &OctreeCell) -> Visit {
        let size = edge(&tree.grid, cell.level);
        let half = tree.grid.cell_units(cell.level) / 2;
        let centre = tree.grid.position(cell.corner.map(|coordinate| coordinate + half));
        let last = cell.level == tree.grid.depth;
        // Half a cell more, so that cells just outside the tissue get the size of those that hold its boundary.
        let radius = size * if last { HALF_DIAGONAL } else { HALF_DIAGONAL + 0.5 };
        debug_assert_eq!(cell.first_child, NONE);
        let held = match cell.held {
            Coverage::Mixed => self.domain.coverage(&centre, radius),
            known @ (Coverage::Inside | Coverage::Outside) => known,
        };
        if last || held == Coverage::Outside {
            return Visit { held, splits: false, wanted: size };
        }
        let wanted = self.wanted(&centre, size, held);
        if size > wanted * (1.0 + 1e-9) {
            return Visit { held, splits: true, wanted };
        }
        let splits = self.keeps_thin
            && held == Coverage::Mixed
            && misses_tissue(self.domain, &tree.grid, cell);
        Visit { held, splits, wanted: if splits { size / 2.0 } else { size } }
    }

    /// The size asked for at a cell.
    fn wanted(&self, centre: &Vector, size: f64, held: Coverage) -> f64 {
        let mut wanted = self.size.at(centre, size * HALF_DIAGONAL);
        if let (Some(at_boundary), Coverage::Mixed) = (self.size.at_boundary, held) {
            wanted = wanted.min(at_boundary);
        }
        if let Some(rule) = self.size.thickness
            && wanted.min(size) > rule.floor
        {
            // What is thicker asks for nothing.
            let limit = wanted.max(size) / rule.factor;
            wanted = wanted.min(rule.size(self.thickness(centre, size, held, limit)));
        }
        wanted.max(self.size.finest)
    }

    /// The thickness of the tissue in a cell where it is below a limit. Away from tissue at its centre the two surfaces are farther from there than
    /// from one another, by about half a diagonal each.
    fn thickness(&self, centre: &Vector, size: f64, held: Coverage, limit: f64) -> f64 {
        let beyond = size * HALF_DIAGONAL;
        let thickness = self.domain.thickness_below(centre, limit + beyond);
        let off = held == Coverage::Mixed && self.domain.value(centre) <= 0.0;
        if off { thickness - beyond } else { thickness }
    }
}

/// The edge of the cells of a level in mm.
fn edge(grid: &Grid, level: u8) -> f64 {
    f64::from(grid.cell_units(level)) * grid.unit
}

/// The part of a leaf that is tissue, roughly.
fn share(held: Coverage) -> f64 {
    match held {
        Coverage::Inside => 1.0,
        Coverage::Mixed => 0.5,
        Coverage::Outside => 0.0,
    }
}
