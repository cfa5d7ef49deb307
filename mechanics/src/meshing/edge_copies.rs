//! Edges along which tissue still touches itself, cut in two with a node of its own for each fan of cells about them.

use super::draft::Draft;
use super::rims::{OddEdge, boundary_faces, odd_edges};
use crate::mesh::disjoint_sets::DisjointSets;

/// Rounds: cells at several such edges are cut one after the other.
const ROUNDS: usize = 12;

/// Cuts all such edges; returns how many.
pub(super) fn part(draft: &mut Draft) -> usize {
    let mut cut = 0;
    for _ in 0..ROUNDS {
        let odd = odd_edges(&boundary_faces(draft));
        if odd.is_empty() {
            break;
        }
        cut += split_disjoint(draft, &odd);
    }
    cut
}

/// Cuts edges that share no cell.
fn split_disjoint(draft: &mut Draft, odd: &[OddEdge]) -> usize {
    let of_nodes = draft.tetrahedra_of_nodes();
    let mut touched = vec![false; draft.tetrahedra.len()];
    let mut cut = 0;
    for &OddEdge { nodes: [one, other], .. } in odd {
        let at_one = of_nodes.row(one as usize).iter().copied();
        let has_other = |tet: &u32| draft.tetrahedra[*tet as usize].contains(&other);
        let about: Vec<u32> = at_one.filter(has_other).collect();
        if about.iter().any(|&tet| touched[tet as usize]) {
            continue;
        }
        about.iter().for_each(|&tet| touched[tet as usize] = true);
        halve(draft, [one, other], &about);
        cut += 1;
    }
    cut
}

/// Halves the cells about an edge, with one node in its middle for each fan of them.
fn halve(draft: &mut Draft, edge: [u32; 2], about: &[u32]) {
    let [one, other] = edge;
    let [a, b] = edge.map(|node| draft.boundaries[node as usize]);
    let shared = a.shared(b);
    let middle = (draft.nodes[one as usize] + draft.nodes[other as usize]) / 2.0;
    let mut copies = Vec::new();
    for fan in fans(draft, edge, about) {
        let node = draft.nodes.len() as u32;
        draft.nodes.push(middle);
        draft.boundaries.push(if shared.is_empty() { a.and(b) } else { shared });
        copies.push(node);
        draft.beside.push(node);
        for tet in fan {
            let whole = draft.tetrahedra[tet as usize];
            let with = |replaced: u32| whole.map(|n| if n == replaced { node } else { n });
            draft.tetrahedra[tet as usize] = with(other);
            draft.tetrahedra.push(with(one));
        }
    }
    draft.copies.push(copies);
}

/// Cells about an edge, those that share faces together.
fn fans(draft: &Draft, edge: [u32; 2], about: &[u32]) -> Vec<Vec<u32>> {
    let nodes = |place: usize| draft.tetrahedra[about[place] as usize];
    let mut joined = DisjointSets::new(about.len());
    for one in 0..about.len() {
        for two in one + 1..about.len() {
            let third = |node: &u32| !edge.contains(node) && nodes(two).contains(node);
            if nodes(one).iter().any(third) {
                joined.join(one as u32, two as u32);
            }
        }
    }
    let mut fans = vec![Vec::new(); about.len()];
    for (place, &tet) in about.iter().enumerate() {
        fans[joined.root(place as u32) as usize].push(tet);
    }
    fans.retain(|fan| !fan.is_empty());
    fans
}
