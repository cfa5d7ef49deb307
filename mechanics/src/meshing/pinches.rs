//! Places where tissue touches itself in a node or along an edge.
//!
//! Only nodes that were moved onto the boundary can be such places: about a cut, tissue is a half disc of cells. The cells at
//! such a node fall into fans, cells of one fan hanging together by faces; each fan gets a copy of the node of its own. An
//! edge whose fans belong to the same copy at both ends stays; then the node that is easier to spare goes back to where it
//! came from, so that the fans are joined or parted there.

use rayon::prelude::*;

use super::warp::{Side, Warp};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::rows::Rows;

/// Rounds of putting nodes back. What is left is taken care of in the finished mesh.
const ROUNDS: usize = 6;

/// The fans of cells at the nodes on the boundary.
pub(super) struct Fans {
    /// For each node with cuts and each of its tetrahedra the number of the fan.
    fan: Rows<u8>,
    /// How many there are at each node.
    pub count: Vec<u8>,
}

/// Result for places where tissue touches itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pinched {
    /// Copies of nodes.
    pub copies: usize,
    pub stepped_back: usize,
}

/// A tetrahedron's face at a node: its other two nodes in order, and the place of the tetrahedron among those of the node.
type FaceAt = ([u32; 2], u32);

/// Puts back nodes at edges where tissue touches itself for good, and finds the fans.
pub(super) fn part(warp: &mut Warp) -> (Fans, Pinched) {
    let mut pinched = Pinched::default();
    let mut fans = Fans::new(warp);
    for _ in 0..ROUNDS {
        let edges = fans.closed_edges(warp);
        if edges.is_empty() {
            break;
        }
        for [one, other] in edges {
            let on_boundary = |node: u32| warp.side[node as usize] == Side::Boundary;
            if on_boundary(one) && on_boundary(other) {
                let node = warp.looser(one, other);
                warp.release(node);
                pinched.stepped_back += 1;
            }
        }
        fans = Fans::new(warp);
    }
    pinched.copies = fans.count.iter().map(|&count| usize::from(count.saturating_sub(1))).sum();
    (fans, pinched)
}

impl Fans {
    fn new(warp: &Warp) -> Fans {
        let nodes = 0..warp.side.len() as u32;
        let found: Vec<(u8, Vec<u8>)> =
            nodes.into_par_iter().map(|node| fans_at(warp, node)).collect();
        let lengths: Vec<u32> = found.iter().map(|(_, fans)| fans.len() as u32).collect();
        let count = found.iter().map(|&(count, _)| count).collect();
        let entries = found.into_iter().flat_map(|(_, fans)| fans).collect();
        Fans { fan: Rows::of_lengths(&lengths, entries), count }
    }

    /// The fan of a node that a tetrahedron belongs to.
    pub fn of(&self, warp: &Warp, node: u32, tet: u32) -> u8 {
        let place = warp.tetrahedra_of.row(node as usize).binary_search(&tet);
        let fans = self.fan.row(node as usize);
        place.ok().and_then(|place| fans.get(place)).copied().unwrap_or_default()
    }

    /// Edges on the boundary about which there are several fans with the same copies of both ends.
    fn closed_edges(&self, warp: &Warp) -> Vec<[u32; 2]> {
        let nodes = 0..warp.side.len() as u32;
        nodes
            .into_par_iter()
            .filter(|&node| warp.side[node as usize] == Side::Boundary)
            .flat_map_iter(|node| self.closed_edges_at(warp, node))
            .collect()
    }

    fn closed_edges_at(&self, warp: &Warp, node: u32) -> Vec<[u32; 2]> {
        let kept: Vec<u32> = kept_at(warp, node).collect();
        let mut others: Vec<u32> = kept
            .iter()
            .flat_map(|&tet| warp.lattice.tetrahedra[tet as usize])
            .filter(|&other| other > node && warp.side[other as usize] == Side::Boundary)
            .collect();
        others.sort_unstable();
        others.dedup();
        others.retain(|&other| self.is_closed(warp, [node, other], &kept));
        others.into_iter().map(|other| [node, other]).collect()
    }

    fn is_closed(&self, warp: &Warp, [node, other]: [u32; 2], kept: &[u32]) -> bool {
        let nodes = |tet: u32| warp.lattice.tetrahedra[tet as usize];
        let about: Vec<u32> =
            kept.iter().copied().filter(|&tet| nodes(tet).contains(&other)).collect();
        let mut joined = DisjointSets::new(about.len());
        for (place, &one) in about.iter().enumerate() {
            for (later, &two) in about.iter().enumerate().skip(place + 1) {
                let third = nodes(one)
                    .into_iter()
                    .find(|&third| third != node && third != other && nodes(two).contains(&third));
                if third.is_some_and(|third| warp.side[third as usize] != Side::Outside) {
                    joined.join(place as u32, later as u32);
                }
            }
        }
        let first_of_fans =
            (0..about.len()).filter(|&place| joined.root(place as u32) == place as u32);
        let mut copies: Vec<[u8; 2]> = first_of_fans
            .map(|place| [node, other].map(|end| self.of(warp, end, about[place])))
            .collect();
        copies.sort_unstable();
        copies.windows(2).any(|pair| pair[0] == pair[1])
    }
}

fn kept_at(warp: &Warp, node: u32) -> impl Iterator<Item = u32> {
    warp.tetrahedra_of.row(node as usize).iter().copied().filter(|&tet| warp.is_kept(tet))
}

/// How many fans there are at a node, and the fan of each of its tetrahedra.
fn fans_at(warp: &Warp, node: u32) -> (u8, Vec<u8>) {
    if warp.side[node as usize] != Side::Boundary {
        return (0, Vec::new());
    }
    let all = warp.tetrahedra_of.row(node as usize);
    let mut faces: Vec<FaceAt> = Vec::with_capacity(3 * all.len());
    for (place, &tet) in all.iter().enumerate() {
        if warp.is_kept(tet) {
            faces_at(warp, node, tet).for_each(|face| faces.push((face, place as u32)));
        }
    }
    faces.sort_unstable();
    let mut joined = DisjointSets::new(all.len());
    for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        joined.join(pair[0].1, pair[1].1);
    }
    let mut fan_of_root = vec![u8::MAX; all.len()];
    let mut count = 0;
    let fans = all.iter().enumerate().map(|(place, &tet)| {
        let root = joined.root(place as u32) as usize;
        if warp.is_kept(tet) && fan_of_root[root] == u8::MAX {
            fan_of_root[root] = count;
            count += 1;
        }
        fan_of_root[root]
    });
    let fans = fans.collect();
    (count, fans)
}

/// The faces of a tetrahedron at a node through which tissue hangs together.
fn faces_at(warp: &Warp, node: u32, tet: u32) -> impl Iterator<Item = [u32; 2]> {
    let nodes = warp.lattice.tetrahedra[tet as usize];
    let mut others = [0; 3];
    let all = nodes.into_iter().filter(|&other| other != node);
    others.iter_mut().zip(all).for_each(|(slot, other)| *slot = other);
    let [a, b, c] = others;
    [[a, b], [b, c], [c, a]].into_iter().filter_map(move |[one, other]| {
        let sides = [one, other].map(|node| warp.side[node as usize]);
        let joins = sides.contains(&Side::Inside) || !sides.contains(&Side::Outside);
        joins.then_some([one.min(other), one.max(other)])
    })
}
