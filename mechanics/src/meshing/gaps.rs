//! Gaps and sheets of tissue thinner than a cell: lattice edges with both ends on one side that cross the other.

use super::error::MeshingError;
use super::lattice::Lattice;
use super::missed::Edge;
use super::octree::Leaves;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;
use crate::mesh::disjoint_sets::DisjointSets;

/// Places of one gap are at most so many finest cells apart along each axis.
const APART: f64 = 3.0;
/// A curved surface reaches across an edge by its square over eight radii: less than this part of it where the radius is
/// longer than six edges.
const DEEP: f64 = 0.02;
/// So many gaps are reported.
const TOLD: usize = 20;

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
}

/// Gaps closed and sheets lost.
#[derive(Debug, Default)]
pub(super) struct Thin {
    pub gaps: Vec<Gap>,
    pub sheets: Vec<Gap>,
}

/// A place on an edge of the lattice that does not lie on the side of its ends.
struct EdgeCrossing {
    ends_inside: bool,
    place: Vector,
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
    let side = |inside: bool| -> Vec<Vector> {
        let met = met.iter().flatten().filter(|met| met.ends_inside == inside);
        met.map(|met| met.place).collect()
    };
    let apart = APART * 2.0 * lattice.grid.unit;
    Ok(Thin { gaps: clusters(&side(true), apart), sheets: clusters(&side(false), apart) })
}

impl Search<'_> {
    fn about(&self, number: u32) -> Vec<EdgeCrossing> {
        self.edges(number).into_iter().filter_map(|[from, to]| self.met(from, to)).collect()
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
        let ends_inside = self.lattice.inside[from as usize];
        if self.lattice.inside[to as usize] != ends_inside {
            return None;
        }
        let ends = [from, to].map(|node| self.lattice.position(node));
        let place = Edge { ends, inside: ends_inside }.missed(self.domain, DEEP)?;
        Some(EdgeCrossing { ends_inside, place })
    }
}

/// Places that lie in neighbouring cubes together, those with most places first.
fn clusters(places: &[Vector], apart: f64) -> Vec<Gap> {
    let cube = |place: &Vector| <[i64; 3]>::from((place / apart).map(|x| x.floor() as i64));
    let mut cubes: Vec<[i64; 3]> = places.iter().map(cube).collect();
    cubes.sort_unstable();
    cubes.dedup();
    let mut joined = DisjointSets::new(cubes.len());
    for (number, cube) in cubes.iter().enumerate() {
        for step in 0..27 {
            let near = [cube[0] + step % 3 - 1, cube[1] + step / 3 % 3 - 1, cube[2] + step / 9 - 1];
            if let Ok(other) = cubes.binary_search(&near) {
                joined.join(number as u32, other as u32);
            }
        }
    }
    let mut of_root: Vec<Option<Gap>> = vec![None; cubes.len()];
    for place in places {
        let number = cubes.binary_search(&cube(place)).unwrap_or_default();
        let gap = &mut of_root[joined.root(number as u32) as usize];
        let gap =
            gap.get_or_insert(Gap { centre: Vector::zeros(), low: *place, high: *place, edges: 0 });
        gap.edges += 1;
        gap.centre += (place - gap.centre) / gap.edges as f64;
        gap.low = gap.low.inf(place);
        gap.high = gap.high.sup(place);
    }
    let mut gaps: Vec<Gap> = of_root.into_iter().flatten().collect();
    gaps.sort_by_key(|gap| std::cmp::Reverse(gap.edges));
    gaps.truncate(TOLD);
    gaps
}
