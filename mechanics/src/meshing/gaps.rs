//! Gaps and sheets of tissue thinner than a cell: lattice edges with both ends on one side that cross the other.
//!
//! Nodes and middles of edges are spread evenly over the lattice: of a cube of it, the node in its centre stands for one half and each of its
//! corners for a sixteenth of its volume, and each middle of its fourteen edges for as much of it.

use super::error::MeshingError;
use super::lattice::Lattice;
use super::missed::Edge;
use super::octree::Leaves;
use super::watch::Watch;
use crate::domain::{Boundary, Coverage, Domain};
use crate::mesh::Vector;
use crate::mesh::clusters::{Clusters, clusters};

/// Places of one gap are at most so many finest cells apart along each axis.
const APART: f64 = 3.0;
/// A curved surface reaches across an edge by its square over eight radii: less than this part of it where the radius is
/// longer than six edges.
const DEEP: f64 = 0.02;
/// So many gaps are reported.
const TOLD: usize = 20;
/// Edges of the lattice for each of its cubes.
const EDGES: f64 = 14.0;

/// A region where the other side is thinner than a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The mean of the places where it was met.
    pub centre: Vector,
    /// The box around them.
    pub low: Vector,
    pub high: Vector,
    /// Lattice edges that met it.
    pub edges: usize,
    /// What is beside it is, at one place at least, the outer skin.
    pub at_skin: bool,
}

/// Gaps of air closed and sheets lost.
#[derive(Debug, Default)]
pub(super) struct Thin {
    pub gaps: Vec<Gap>,
    pub sheets: Vec<Gap>,
    /// Of all tissue before it is meshed, in mm³.
    pub tissue: f64,
    /// Of all gaps, in mm³.
    pub filled: f64,
    /// Of all sheets as far as edges met them, in mm³.
    pub met: f64,
}

/// A place on an edge of the lattice that does not lie on the side of its ends.
#[derive(Clone, Copy)]
struct EdgeCrossing {
    ends_inside: bool,
    place: Vector,
    /// What it stands for, in mm³.
    volume: f64,
    /// Where tissue ends on the way to it, or begins.
    boundary: Boundary,
}

/// Candidates of gaps.
struct Search<'a> {
    lattice: &'a Lattice,
    leaves: &'a Leaves,
    domain: &'a dyn Domain,
}

/// Looks at the middles of lattice edges about leaves that hold a boundary.
pub(super) fn find(
    lattice: &Lattice,
    leaves: &Leaves,
    domain: &dyn Domain,
    watch: &Watch,
) -> Result<Thin, MeshingError> {
    let numbers = 0..leaves.list.len() as u32;
    let mixed = |&leaf: &u32| leaves.list[leaf as usize].held == Coverage::Mixed;
    let numbers: Vec<u32> = numbers.filter(mixed).collect();
    let search = Search { lattice, leaves, domain };
    let met = watch.map(&numbers, |&number| search.about(number))?;
    let met: Vec<EdgeCrossing> = met.into_iter().flatten().collect();
    let apart = APART * 2.0 * lattice.grid.unit;
    let (gaps, sheets): (Vec<EdgeCrossing>, Vec<EdgeCrossing>) =
        met.into_iter().partition(|met| met.ends_inside);
    let volume = |met: &[EdgeCrossing]| met.iter().map(|met| met.volume).sum::<f64>();
    let air: Vec<EdgeCrossing> =
        gaps.iter().filter(|met| met.boundary != Boundary::Bone).copied().collect();
    Ok(Thin {
        gaps: self::gaps(&air, apart),
        sheets: self::gaps(&sheets, apart),
        tissue: tissue(lattice, leaves),
        filled: volume(&gaps),
        met: volume(&sheets),
    })
}

/// The volume of the body by the nodes of the lattice that lie in it, in mm³.
fn tissue(lattice: &Lattice, leaves: &Leaves) -> f64 {
    let share = |node: u32, of: f64| if lattice.inside[node as usize] { of } else { 0.0 };
    let volume = |(centre, corners): (usize, &[u32; 8])| {
        let edge = f64::from(leaves.list[centre].size) * lattice.grid.unit;
        let corners: f64 = corners.iter().map(|&corner| share(corner, 1.0 / 16.0)).sum();
        edge.powi(3) * (share(centre as u32, 0.5) + corners)
    };
    lattice.corners.iter().enumerate().map(volume).sum()
}

impl Search<'_> {
    fn about(&self, number: u32) -> Vec<EdgeCrossing> {
        let cube = f64::from(self.leaves.list[number as usize].size) * self.lattice.grid.unit;
        let met = |[from, to]: [u32; 2]| self.met(from, to, cube);
        self.edges(number).into_iter().filter_map(met).collect()
    }

    /// From the centre of a leaf to its corners, and those along the axes towards higher coordinates from its lowest corner
    /// and from its centre. Centres are numbered as their leaves.
    fn edges(&self, number: u32) -> Vec<[u32; 2]> {
        let corners = &self.lattice.corners[number as usize];
        let leaf = &self.leaves.list[number as usize];
        let mut edges: Vec<[u32; 2]> = corners.iter().map(|&corner| [number, corner]).collect();
        for axis in 0..3 {
            edges.push([corners[0], corners[1 << axis]]);
            let mut beyond = leaf.corner;
            beyond[axis] += leaf.size;
            edges.extend(self.leaves.at(beyond).map(|other| [number, other]));
        }
        edges
    }

    fn met(&self, from: u32, to: u32, cube: f64) -> Option<EdgeCrossing> {
        let ends_inside = self.lattice.inside[from as usize];
        if self.lattice.inside[to as usize] != ends_inside {
            return None;
        }
        let ends = [from, to].map(|node| self.lattice.position(node));
        let place = Edge { ends, inside: ends_inside }.missed(self.domain, DEEP)?;
        let [inside, outside] = if ends_inside { [ends[0], place] } else { [place, ends[0]] };
        let boundary = self.domain.crossing(&inside, &outside).boundary;
        Some(EdgeCrossing { ends_inside, place, volume: cube.powi(3) / EDGES, boundary })
    }
}

/// Places that lie in neighbouring cubes together, those with most places first.
fn gaps(met: &[EdgeCrossing], apart: f64) -> Vec<Gap> {
    let places: Vec<Vector> = met.iter().map(|met| met.place).collect();
    let Clusters { of_place, count } = clusters(&places, apart);
    let mut of_cluster: Vec<Option<Gap>> = vec![None; count];
    for (EdgeCrossing { place, boundary, .. }, cluster) in met.iter().zip(of_place) {
        let gap = &mut of_cluster[cluster];
        let gap = gap.get_or_insert(Gap {
            centre: Vector::zeros(),
            low: *place,
            high: *place,
            edges: 0,
            at_skin: false,
        });
        gap.at_skin |= *boundary == Boundary::Skin;
        gap.edges += 1;
        gap.centre += (place - gap.centre) / gap.edges as f64;
        gap.low = gap.low.inf(place);
        gap.high = gap.high.sup(place);
    }
    let mut gaps: Vec<Gap> = of_cluster.into_iter().flatten().collect();
    gaps.sort_by_key(|gap| std::cmp::Reverse(gap.edges));
    gaps.truncate(TOLD);
    gaps
}
