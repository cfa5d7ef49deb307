//! Places where edges of the lattice cross the boundary of the tissue.

use rayon::prelude::*;

use super::error::MeshingError;
use super::lattice::Lattice;
use super::watch::Watch;
use crate::domain::{Boundary, Domain};
use crate::mesh::Vector;
use crate::rows::Rows;

/// The edges of a tetrahedron as pairs of local nodes.
pub(super) const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Where the edge between a node in tissue and one outside crosses the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub inside: u32,
    pub outside: u32,
    pub point: Vector,
    pub boundary: Boundary,
}

pub(super) struct Cuts {
    /// Ascending by their inner, then by their outer node.
    pub list: Vec<Cut>,
    /// For each node of the lattice the cuts on its edges.
    pub of_node: Rows<u32>,
}

impl Cuts {
    /// Of a lattice, with its nodes where they are.
    pub fn new(
        lattice: &Lattice,
        domain: &dyn Domain,
        watch: &Watch,
    ) -> Result<Cuts, MeshingError> {
        let edges = crossed_edges(lattice, watch)?;
        let list = watch.map(&edges, |&edge| {
            let [inside, outside] = [(edge >> 32) as u32, edge as u32];
            let ends = [lattice.position(inside), lattice.position(outside)];
            cut_between(domain, [inside, outside], ends)
        })?;
        if let Some(cut) = list.iter().find(|cut| !cut.point.iter().all(|x| x.is_finite())) {
            let at = lattice.position(cut.inside);
            return Err(MeshingError::NotFinite { what: "crossing", at });
        }
        let of_node = by_node(&list, lattice.inside.len());
        Ok(Cuts { list, of_node })
    }

    /// The number of the cut between two nodes.
    pub fn between(&self, inside: u32, outside: u32) -> Option<u32> {
        let of_node = self.of_node.row(inside as usize);
        of_node.iter().copied().find(|&cut| self.list[cut as usize].outside == outside)
    }
}

/// Asks the body, and keeps what it says on the segment.
pub(super) fn cut_between(
    domain: &dyn Domain,
    [inside, outside]: [u32; 2],
    [from, to]: [Vector; 2],
) -> Cut {
    let crossing = domain.crossing(&from, &to);
    let along = to - from;
    let share = (crossing.point - from).dot(&along) / along.norm_squared();
    // NaN goes through, to be refused.
    let point = from + along * share.clamp(0.0, 1.0);
    Cut { inside, outside, point, boundary: crossing.boundary }
}

/// The edges between nodes in tissue and nodes outside, each once, ascending: the inner node before the outer one.
fn crossed_edges(lattice: &Lattice, watch: &Watch) -> Result<Vec<u64>, MeshingError> {
    let mut edges = watch.gather(&lattice.tetrahedra, |tetrahedra, list| {
        for tet in tetrahedra {
            let inside = tet.map(|node| lattice.inside[node as usize]);
            if inside == [true; 4] {
                continue;
            }
            for [a, b] in EDGES {
                if inside[a] != inside[b] {
                    let (from, to) = if inside[a] { (tet[a], tet[b]) } else { (tet[b], tet[a]) };
                    list.push(u64::from(from) << 32 | u64::from(to));
                }
            }
        }
    })?;
    edges.par_sort_unstable();
    edges.dedup();
    Ok(edges)
}

fn by_node(list: &[Cut], nodes: usize) -> Rows<u32> {
    let mut lengths = vec![0; nodes];
    let ends = |cut: &Cut| [cut.inside as usize, cut.outside as usize];
    list.iter().flat_map(ends).for_each(|node| lengths[node] += 1);
    let mut sorting = crate::rows::Sorting::new(&lengths, 0);
    for (number, cut) in list.iter().enumerate() {
        ends(cut).into_iter().for_each(|node| sorting.put(node, number as u32));
    }
    sorting.finish()
}
