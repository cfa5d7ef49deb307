//! Gaps and sheets of tissue thinner than a cell: lattice edges whose ends lie on one side, and on whose way the other is met.

use super::error::MeshingError;
use super::lattice::Lattice;
use super::octree::Leaves;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;
use crate::mesh::disjoint_sets::DisjointSets;

/// Places of one gap are at most so many finest cells apart along each axis.
const APART: f64 = 3.0;
/// So many gaps are told of.
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

/// Looks along the edges from the centres of leaves that hold a boundary to their corners.
pub(super) fn find(
    lattice: &Lattice,
    leaves: &Leaves,
    domain: &dyn Domain,
    watch: &Watch,
) -> Result<Thin, MeshingError> {
    let numbers: Vec<u32> = (0..leaves.list.len() as u32).collect();
    let numbers: Vec<u32> = numbers
        .into_iter()
        .filter(|&leaf| leaves.list[leaf as usize].held == Coverage::Mixed)
        .collect();
    let met = watch.map(&numbers, |&number| met_at(lattice, number, domain))?;
    let side = |wanted: bool| -> Vec<Vector> {
        let met = numbers
            .iter()
            .zip(&met)
            .filter(|(number, _)| lattice.inside[**number as usize] == wanted);
        met.flat_map(|(_, places)| places.iter().copied()).collect()
    };
    let apart = APART * 2.0 * lattice.grid.unit;
    Ok(Thin { gaps: clusters(&side(true), apart), sheets: clusters(&side(false), apart) })
}

/// Where edges from the centre of a leaf to corners on its own side meet the other side. Centres are numbered as their leaves.
fn met_at(lattice: &Lattice, number: u32, domain: &dyn Domain) -> Vec<Vector> {
    let inside = lattice.inside[number as usize];
    let corners = lattice.corners[number as usize].into_iter();
    let own_side = corners.filter(|&corner| lattice.inside[corner as usize] == inside);
    let middles =
        own_side.map(|corner| (lattice.position(number) + lattice.position(corner)) / 2.0);
    middles.filter(|middle| (domain.value(middle) > 0.0) != inside).collect()
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
