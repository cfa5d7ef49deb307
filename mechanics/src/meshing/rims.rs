//! The boundary of a mesh in the making: its triangles, and its edges with other than two of them.

use rayon::prelude::*;

use super::boundary_set::BoundarySet;
use super::draft::{Draft, FACES};
use crate::mesh::check::referenced;

/// A face of one tetrahedron alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RimFace {
    /// Counter-clockwise seen from outside, the lowest first.
    pub nodes: [u32; 3],
    pub tet: u32,
}

/// An edge of the boundary with other than two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OddEdge {
    pub nodes: [u32; 2],
    pub triangles: usize,
}

/// The faces without a partner among those whose nodes all lie on the boundary; that no other face is without one is
/// shown by [`unmatched_print`].
pub(super) fn boundary_faces(draft: &Draft) -> Vec<RimFace> {
    let on_boundary = |&node: &u32| !draft.boundaries[node as usize].is_empty();
    let mut faces: Vec<([u32; 3], RimFace)> = draft
        .tetrahedra
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, tet)| {
            let candidates = tet.iter().filter(|node| on_boundary(node)).count() >= 3;
            let faces = FACES.iter().take(if candidates { 4 } else { 0 });
            faces.filter_map(move |face| {
                let nodes = face.map(|local| tet[local]);
                if !nodes.iter().all(on_boundary) {
                    return None;
                }
                let mut sorted = nodes;
                sorted.sort_unstable();
                Some((sorted, RimFace { nodes: lowest_first(nodes), tet: number as u32 }))
            })
        })
        .collect();
    faces.par_sort_unstable();
    let alone = faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
    alone.map(|same| same[0].1).collect()
}

/// Nodes that bound no face of the boundary lie on none, as where a gap thinner than a cell was filled around one.
pub(super) fn clear_inner(draft: &mut Draft, faces: &[RimFace]) {
    let bounds = referenced(draft.nodes.len(), faces.iter().flat_map(|face| &face.nodes));
    let inner = draft.boundaries.iter_mut().zip(bounds).filter(|(_, bounds)| !bounds);
    inner.for_each(|(boundary, _)| *boundary = BoundarySet::NONE);
}

/// Edges of the boundary that do not lie between exactly two triangles, ascending.
pub(super) fn odd_edges(faces: &[RimFace]) -> Vec<OddEdge> {
    let mut edges: Vec<[u32; 2]> = faces
        .par_iter()
        .flat_map_iter(|face| {
            let [a, b, c] = face.nodes;
            [[a, b], [b, c], [c, a]].into_iter().map(|[a, b]| [a.min(b), a.max(b)])
        })
        .collect();
    edges.par_sort_unstable();
    let groups = edges.chunk_by(|a, b| a == b).filter(|same| same.len() != 2);
    groups.map(|same| OddEdge { nodes: same[0], triangles: same.len() }).collect()
}

/// A sum over all faces of all tetrahedra that do not bound the mesh, in which a face and its partner, which has the other
/// orientation, cancel: 0 where each has exactly one, and else 0 with a chance of 2^-64.
pub(super) fn unmatched_print(draft: &Draft, boundary: &[RimFace]) -> u64 {
    let faces = |tet: &[u32; 4]| {
        let prints = FACES.map(|face| print(lowest_first(face.map(|local| tet[local]))));
        prints.into_iter().fold(0, u64::wrapping_add)
    };
    let all = draft.tetrahedra.par_iter().map(faces).reduce(|| 0, u64::wrapping_add);
    boundary.iter().map(|face| print(face.nodes)).fold(all, u64::wrapping_sub)
}

/// The faces, by their sorted nodes, that have other than one partner and do not bound the mesh: a search in all of them.
pub(super) fn open_faces(draft: &Draft) -> Vec<[u32; 3]> {
    let faces = draft.tetrahedra.iter().flat_map(|tet| {
        FACES.map(|face| {
            let mut nodes = face.map(|local| tet[local]);
            nodes.sort_unstable();
            nodes
        })
    });
    let mut faces: Vec<[u32; 3]> = faces.collect();
    faces.par_sort_unstable();
    let bounds =
        |face: &[u32; 3]| face.iter().all(|&node| !draft.boundaries[node as usize].is_empty());
    let groups = faces.chunk_by(|a, b| a == b);
    let open = groups.filter(|same| same.len() > 2 || same.len() == 1 && !bounds(&same[0]));
    open.map(|same| same[0]).collect()
}

/// A number for a face, negated for the other orientation.
fn print([a, b, c]: [u32; 3]) -> u64 {
    let (low, high) = (b.min(c), b.max(c));
    let mixed = mix(mix(u64::from(a) << 32 | u64::from(low)) ^ u64::from(high));
    if b < c { mixed } else { mixed.wrapping_neg() }
}

/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
fn mix(mut bits: u64) -> u64 {
    bits = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ bits >> 31
}

fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
