//! The integer coordinates in which a lattice is numbered.

use super::error::MeshingError;
use super::size::SizeField;
use crate::mesh::Vector;

/// Coordinates of a lattice node, in halves of the finest cell.
pub(super) type Coordinates = [u32; 3];

/// Bits of a coordinate in the key of a node.
const BITS: u32 = 21;

/// Cells at the top of the octree along the longest axis.
const ROOTS: f64 = 6.0;

/// Room around the tissue in cells of the coarsest size: all nodes of the outermost leaves lie outside. Not a simple
/// fraction, so that no lattice plane lies in a face of a box.
const MARGIN: f64 = 1.618;

/// Where the lattice lies and how fine it gets.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub origin: Vector,
    /// Half the edge of the finest cells in mm.
    pub unit: f64,
    /// How often a cell at the top is halved at most.
    pub depth: u8,
    /// Cells at the top along each axis.
    pub roots: [u32; 3],
}

impl Grid {
    /// A lattice around a box.
    pub fn new(low: &Vector, high: &Vector, size: &SizeField) -> Result<Grid, MeshingError> {
        let finite = low.iter().chain(high.iter()).all(|x| x.is_finite());
        let margin = MARGIN * size.coarsest;
        let extent = (high - low).add_scalar(2.0 * margin);
        if !finite || (high - low).min() < 0.0 {
            return Err(MeshingError::Bounds { low: *low, high: *high });
        }
        let cells = extent.max() / size.finest;
        let allowed = 1 << (BITS - 3);
        if cells > f64::from(allowed) {
            return Err(MeshingError::TooFine { cells, allowed, finest: size.finest });
        }
        // Coarse enough for the space around the tissue; inside, sizes are bound by their rules.
        let widest = (size.coarsest / size.finest).max(cells / ROOTS);
        let depth = widest.log2().floor().clamp(0.0, f64::from(BITS - 3)) as u8;
        let root = size.finest * f64::from(1_u32 << depth);
        let roots = [0, 1, 2].map(|axis| (extent[axis] / root).ceil().max(1.0) as u32);
        let origin = low.add_scalar(-margin);
        Ok(Grid { origin, unit: size.finest / 2.0, depth, roots })
    }

    /// The edge of a cell of a level in units; level 0 is the top.
    pub fn cell_units(&self, level: u8) -> u32 {
        2 << (self.depth - level)
    }

    pub fn position(&self, at: Coordinates) -> Vector {
        self.origin + Vector::from(at.map(f64::from)) * self.unit
    }

    /// One number for a node.
    pub fn key(at: Coordinates) -> u64 {
        at.iter().fold(0, |key, &coordinate| key << BITS | u64::from(coordinate))
    }
}
