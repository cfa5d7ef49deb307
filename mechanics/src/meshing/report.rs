//! Report of a meshing: counts, dihedral angles, what was closed, lost and dropped.

use rayon::prelude::*;

use super::draft::Draft;
use super::gaps::Gap;
use super::lost::LostPiece;
use super::pieces::Piece;
use super::shape::dihedral_cosines;

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
    /// Nodes moved to where two boundaries meet.
    pub creased: usize,
    /// Nodes moved so that as much volume lies on the one side of the boundary as on the other.
    pub fitted: usize,
    /// Pieces that were left out, the largest first.
    pub dropped: Vec<Piece>,
    /// Gaps of air that are thinner than a cell and have been filled, the largest first.
    pub gaps_closed: Vec<Gap>,
    /// Pairs of triangles of the boundary that still cross where copies of nodes are moved apart; 0 where they are not.
    pub crossings: u64,
    /// Nodes at which two voids still touch where copies of nodes are moved apart; 0 where they are not.
    pub voids_touching: usize,
    /// Of all tissue that is thinner than cells and in none, in mm³.
    pub volume_lost: f64,
    /// The largest connected pieces of it, the largest first.
    pub pieces_lost: Vec<LostPiece>,
}

impl MeshingReport {
    /// Of all pieces that were left out, in mm³.
    pub fn dropped_volume(&self) -> f64 {
        // The sum of no numbers is -0.
        self.dropped.iter().map(|piece| piece.volume).sum::<f64>() + 0.0
    }
}

/// Angles are counted in so many classes of their cosine: a hundredth of a degree at 20 degrees and above.
const CLASSES: usize = 40_000;

impl Angles {
    pub(super) fn of(draft: &Draft) -> Angles {
        let counts = draft.tetrahedra.par_chunks(1 << 14).map(|cells| {
            let mut counts = Counts::new();
            cells.iter().for_each(|tet| counts.add(dihedral_cosines(&draft.corners(tet))));
            counts
        });
        counts.reduce(Counts::new, Counts::and).angles()
    }
}

struct Counts {
    /// From the largest cosine, of the smallest angle, downwards.
    classes: Vec<u32>,
    largest_cosine: f64,
    smallest_cosine: f64,
    cells_below_ten: usize,
}

impl Counts {
    fn new() -> Counts {
        let classes = vec![0; CLASSES];
        Counts { classes, largest_cosine: -1.0, smallest_cosine: 1.0, cells_below_ten: 0 }
    }

    fn add(&mut self, cosines: [f64; 6]) {
        let mut largest = -1.0_f64;
        for cosine in cosines {
            largest = largest.max(cosine);
            self.smallest_cosine = self.smallest_cosine.min(cosine);
            let class = (1.0 - cosine) * (CLASSES as f64 / 2.0);
            self.classes[(class as usize).min(CLASSES - 1)] += 1;
        }
        self.largest_cosine = self.largest_cosine.max(largest);
        // The cosine of ten degrees.
        self.cells_below_ten += usize::from(largest > 0.984_807_753_012_208);
    }

    fn and(mut self, other: Counts) -> Counts {
        self.classes.iter_mut().zip(&other.classes).for_each(|(count, more)| *count += more);
        self.largest_cosine = self.largest_cosine.max(other.largest_cosine);
        self.smallest_cosine = self.smallest_cosine.min(other.smallest_cosine);
        self.cells_below_ten += other.cells_below_ten;
        self
    }

    fn angles(&self) -> Angles {
        Angles {
            smallest: degrees(self.largest_cosine),
            thousandth: self.quantile(0.001),
            hundredth: self.quantile(0.01),
            largest: degrees(self.smallest_cosine),
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
        degrees(1.0 - class.unwrap_or_default() as f64 * (2.0 / CLASSES as f64))
    }
}

fn degrees(cosine: f64) -> f64 {
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}
