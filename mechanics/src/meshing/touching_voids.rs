//! Nodes at which two voids touch, as an airway and bone: fans of boundary triangles that share the node alone.
//!
//! The tip of one void is cut off: a new node in it takes the triangles of its fan, cells between them and the old node fill the tip.
//! Meshers that are handed such a boundary (Gmsh's HXT) find facets that intersect at the node.

use super::draft::Draft;
use super::rims::boundary_faces;
use super::shape::worst_sine;
use crate::mesh::Vector;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::rows::{Rows, Sorting};

/// How far into the void the new node may lie, in parts of the way to the middle of the rim of its fan.
const PARTS: [f64; 5] = [0.25, 0.35, 0.5, 0.65, 0.8];

/// A fan of triangles about a node, as the edges opposite to it, counter-clockwise seen from outside.
type Fan = Vec<[u32; 2]>;

/// What fills the tip of a void.
struct Tip {
    node: u32,
    fan: Fan,
    place: Vector,
    worst: f64,
}

/// Parts voids that touch at a node; returns at how many nodes they still do, because each cell that could part them is turned over.
pub(super) fn part(draft: &mut Draft) -> usize {
    loop {
        let mut is_changed = vec![false; draft.nodes.len()];
        let (mut filled, mut left) = (0, 0);
        let of_nodes = triangles_of_nodes(draft);
        for node in 0..of_nodes.len() {
            let fans = fans(of_nodes.row(node));
            // The triangles of what is filled already are other ones: that is for the next round.
            let rims = fans.iter().flatten().flatten();
            if fans.len() < 2 || is_changed[node] || rims.clone().any(|at| is_changed[*at as usize])
            {
                continue;
            }
            let tips = fans.iter().filter_map(|fan| tip(draft, node as u32, fan));
            let Some(tip) = tips.max_by(|a, b| a.worst.total_cmp(&b.worst)) else {
                left += 1;
                continue;
            };
            filled += 1;
            is_changed[node] = true;
            tip.fan.iter().flatten().for_each(|at| is_changed[*at as usize] = true);
            fill(draft, tip);
        }
        if filled == 0 {
            return left;
        }
    }
}

/// For each node the edges opposite to it of its boundary triangles.
fn triangles_of_nodes(draft: &Draft) -> Rows<[u32; 2]> {
    let faces = boundary_faces(draft);
    let mut lengths = vec![0; draft.nodes.len()];
    faces.iter().flat_map(|face| face.nodes).for_each(|node| lengths[node as usize] += 1);
    let mut sorting = Sorting::new(&lengths, [0; 2]);
    for face in &faces {
        let [a, b, c] = face.nodes;
        for (node, edge) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            sorting.put(node as usize, edge);
        }
    }
    sorting.finish()
}

/// Triangles about a node, those that share edges together.
fn fans(edges: &[[u32; 2]]) -> Vec<Fan> {
    let mut joined = DisjointSets::new(edges.len());
    for (one, [from, to]) in edges.iter().enumerate() {
        for (other, edge) in edges.iter().enumerate().skip(one + 1) {
            if edge.contains(from) || edge.contains(to) {
                joined.join(one as u32, other as u32);
            }
        }
    }
    let mut fans = vec![Fan::new(); edges.len()];
    for (place, edge) in edges.iter().enumerate() {
        fans[joined.root(place as u32) as usize].push(*edge);
    }
    fans.retain(|fan| !fan.is_empty());
    fans
}

/// The best place for a new node in the void of a fan, if one gives cells of positive volume.
fn tip(draft: &Draft, node: u32, fan: &[[u32; 2]]) -> Option<Tip> {
    let at = |node: u32| draft.nodes[node as usize];
    let rim: Vector = fan.iter().map(|&[from, _]| at(from)).sum();
    let way = rim / fan.len() as f64 - at(node);
    let tips = PARTS.map(|part| {
        let place = at(node) + way * part;
        let sines = fan.iter().map(|&[a, b]| worst_sine(&[at(node), at(a), at(b), place]));
        Tip { node, fan: fan.to_vec(), place, worst: sines.fold(f64::INFINITY, f64::min) }
    });
    let best = tips.into_iter().max_by(|a, b| a.worst.total_cmp(&b.worst));
    best.filter(|tip| tip.worst > 0.0)
}

fn fill(draft: &mut Draft, Tip { node, fan, place, .. }: Tip) {
    let new = draft.nodes.len() as u32;
    let rim = fan.iter().map(|[from, _]| draft.boundaries[*from as usize]);
    let shared = rim.reduce(|all, own| all.shared(own)).unwrap_or_default();
    let own = draft.boundaries[node as usize];
    draft.nodes.push(place);
    draft.boundaries.push(if shared.is_empty() { own } else { shared });
    draft.beside.push(new);
    draft.tetrahedra.extend(fan.iter().map(|&[a, b]| [node, a, b, new]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Boundary;
    use crate::meshing::boundary_set::BoundarySet;
    use crate::meshing::rims::odd_edges;

    /// Cubes of five tetrahedra in a block of 3 x 3 x 3 without two of them that share a corner alone.
    fn block_with_two_voids() -> Draft {
        let number = |[x, y, z]: [u32; 3]| x + 4 * (y + 4 * z);
        let mut draft = Draft::default();
        for place in 0..64 {
            let at = [place % 4, place / 4 % 4, place / 16];
            draft.nodes.push(Vector::from(at.map(f64::from)));
            draft.boundaries.push(BoundarySet::from(Boundary::Bone));
        }
        for cube in 0..27_u32 {
            let low = [cube % 3, cube / 3 % 3, cube / 9];
            if low == [0, 1, 0] || low == [1, 2, 1] {
                continue;
            }
            let odd = low.iter().sum::<u32>() % 2;
            // Seen from a corner that is even in the block, so that faces of neighbours meet.
            let corner = |bits: u32| number([0, 1, 2].map(|axis| low[axis] + (bits >> axis & 1)));
            let tets = match odd {
                0 => [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]],
                _ => [[1, 3, 0, 5], [2, 0, 3, 6], [4, 6, 5, 0], [7, 5, 6, 3], [0, 3, 5, 6]],
            };
            for tet in tets {
                let mut tet = tet.map(corner);
                if draft.volume(&tet) < 0.0 {
                    tet.swap(0, 1);
                }
                draft.tetrahedra.push(tet);
            }
        }
        draft
    }

    fn nodes_with_two_fans(draft: &Draft) -> usize {
        let of_nodes = triangles_of_nodes(draft);
        (0..of_nodes.len()).filter(|&node| fans(of_nodes.row(node)).len() > 1).count()
    }

    #[test]
    fn voids_that_touch_at_a_node_are_parted_by_cells() {
        let mut draft = block_with_two_voids();
        assert_eq!(nodes_with_two_fans(&draft), 1);
        let volume =
            |draft: &Draft| draft.tetrahedra.iter().map(|tet| draft.volume(tet)).sum::<f64>();
        let (cells, before) = (draft.tetrahedra.len(), volume(&draft));
        assert_eq!(part(&mut draft), 0);
        assert_eq!(nodes_with_two_fans(&draft), 0);
        assert!(odd_edges(&boundary_faces(&draft)).is_empty());
        let new = &draft.tetrahedra[cells..];
        assert!(!new.is_empty() && new.iter().all(|tet| draft.volume(tet) > 0.0));
        let grown = volume(&draft) - before;
        assert!(grown > 0.0 && grown < 0.5, "{grown}");
    }
}
