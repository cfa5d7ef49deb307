//! Gaps of air thinner than a cell: lattice edges with both ends in tissue and their middle outside.

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

/// Air between tissue that is thinner than a cell.
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

/// A place on an edge of the lattice that lies outside, between ends in tissue.
#[derive(Clone, Copy)]
struct EdgeCrossing {
    place: Vector,
    /// Where tissue ends on the way to it.
    boundary: Boundary,
}

/// Candidates of gaps.
struct Search<'a> {
    lattice: &'a Lattice,
    leaves: &'a Leaves,
    domain: &'a dyn Domain,
}

/// Looks at the middles of lattice edges about leaves that hold a boundary; the largest gap first.
pub(super) fn find(
    lattice: &Lattice,
    leaves: &Leaves,
    domain: &dyn Domain,
    watch: &Watch,
) -> Result<Vec<Gap>, MeshingError> {
    let numbers = 0..leaves.list.len() as u32;
    let mixed = |&leaf: &u32| leaves.list[leaf as usize].held == Coverage::Mixed;
    let numbers: Vec<u32> = numbers.filter(mixed).collect();
    let search = Search { lattice, leaves, domain };
    let met = watch.map(&numbers, |&number| search.about(number))?;
    let is_air = |met: &EdgeCrossing| met.boundary != Boundary::Bone;
    let air: Vec<EdgeCrossing> = met.into_iter().flatten().filter(is_air).collect();
    Ok(gaps(&air, APART * 2.0 * lattice.grid.unit))
}

impl Search<'_> {
    fn about(&self, number: u32) -> Vec<EdgeCrossing> {
        let met = |[from, to]: [u32; 2]| self.met(from, to);
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

    fn met(&self, from: u32, to: u32) -> Option<EdgeCrossing> {
        if ![from, to].iter().all(|&node| self.lattice.inside[node as usize]) {
            return None;
        }
        let ends = [from, to].map(|node| self.lattice.position(node));
        let place = Edge { ends, inside: true }.missed(self.domain, DEEP)?;
        let boundary = self.domain.crossing(&ends[0], &place).boundary;
        Some(EdgeCrossing { place, boundary })
    }
}

/// Places that lie in neighbouring cubes together, those with most places first.
fn gaps(met: &[EdgeCrossing], apart: f64) -> Vec<Gap> {
    let places: Vec<Vector> = met.iter().map(|met| met.place).collect();
    let Clusters { of_place, count } = clusters(&places, apart);
    let mut of_cluster: Vec<Option<Gap>> = vec![None; count];
    for (EdgeCrossing { place, boundary }, cluster) in met.iter().zip(of_place) {
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
