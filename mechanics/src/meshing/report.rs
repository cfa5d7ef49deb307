//! What a reader must know of a mesh that was made.

use rayon::prelude::*;

use super::draft::Draft;
use super::gaps::Gap;
use super::pieces::Piece;
use super::shape::dihedral_angles;

/// The dihedral angles of a mesh, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    pub smallest: f64,
    /// A thousandth of all angles of all cells is smaller.
    pub thousandth: f64,
    /// A hundredth is smaller.
    pub hundredth: f64,
    pub largest: f64,
    /// Cells with an angle below ten degrees.
    pub cells_below_ten: usize,
}

/// How a mesh came about.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshingReport {
    pub nodes: usize,
    pub tetrahedra: usize,
    pub boundary_triangles: usize,
    /// In mm³.
    pub volume: f64,
    /// Before and after nodes were moved to better places.
    pub raw_angles: Angles,
    pub angles: Angles,
    /// The size of the finest cells that were allowed, in mm; what came of a target.
    pub finest: f64,
    pub leaves: usize,
    /// Lattice nodes moved onto the boundary, and those put back because a cell would have been flat.
    pub snapped: usize,
    pub undone: usize,
    /// Copies of nodes where tissue touches itself.
    pub copies: usize,
    /// Nodes put back where tissue touched itself along an edge.
    pub stepped_back: usize,
    /// Edges cut in two because tissue touched itself along them.
    pub edges_cut: usize,
    /// Pieces that were left out, the largest first.
    pub dropped: Vec<Piece>,
    /// Gaps in the tissue that are thinner than a cell and have been filled, the largest first.
    pub gaps_closed: Vec<Gap>,
    /// Tissue that is thinner than a cell and has been lost, the largest first.
    pub sheets_lost: Vec<Gap>,
}

/// Angles are counted in classes of a hundredth of a degree.
const CLASSES: usize = 18_000;

impl Angles {
    pub(super) fn of(draft: &Draft) -> Angles {
        let counts = draft.tetrahedra.par_chunks(1 << 14).map(|cells| {
            let mut counts = Counts::new();
            cells.iter().for_each(|tet| counts.add(dihedral_angles(&draft.corners(tet))));
            counts
        });
        counts.reduce(Counts::new, Counts::and).angles()
    }
}

struct Counts {
    classes: Vec<u32>,
    smallest: f64,
    largest: f64,
    cells_below_ten: usize,
}

impl Counts {
    fn new() -> Counts {
        Counts { classes: vec![0; CLASSES], smallest: 180.0, largest: 0.0, cells_below_ten: 0 }
    }

    fn add(&mut self, angles: [f64; 6]) {
        for angle in angles {
            self.smallest = self.smallest.min(angle);
            self.largest = self.largest.max(angle);
            self.classes[((angle * 100.0) as usize).min(CLASSES - 1)] += 1;
        }
        self.cells_below_ten += usize::from(angles.iter().any(|&angle| angle < 10.0));
    }

    fn and(mut self, other: Counts) -> Counts {
        self.classes.iter_mut().zip(&other.classes).for_each(|(count, more)| *count += more);
        self.smallest = self.smallest.min(other.smallest);
        self.largest = self.largest.max(other.largest);
        self.cells_below_ten += other.cells_below_ten;
        self
    }

    fn angles(&self) -> Angles {
        Angles {
            smallest: self.smallest,
            thousandth: self.quantile(0.001),
            hundredth: self.quantile(0.01),
            largest: self.largest,
            cells_below_ten: self.cells_below_ten,
        }
    }

    /// The lower end of the class in which a part of all angles is reached.
    fn quantile(&self, part: f64) -> f64 {
        let all: u64 = self.classes.iter().map(|&count| u64::from(count)).sum();
        let wanted = all as f64 * part;
        let mut below = 0_u64;
        let class = self.classes.iter().position(|&count| {
            below += u64::from(count);
            below as f64 > wanted
        });
        class.unwrap_or_default() as f64 / 100.0
    }
}
