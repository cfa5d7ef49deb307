//! Pieces of a mesh that share no node.

use super::draft::Draft;
use crate::mesh::Vector;
use crate::mesh::disjoint_sets::DisjointSets;

/// Cells that hang together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    pub tetrahedra: usize,
    /// In mm³.
    pub volume: f64,
    /// Its centre of mass.
    pub centre: Vector,
}

/// The pieces, the largest first, and the piece of each tetrahedron.
pub(super) fn pieces(draft: &Draft) -> (Vec<Piece>, Vec<u32>) {
    let mut joined = DisjointSets::new(draft.nodes.len());
    for tet in &draft.tetrahedra {
        tet[1..].iter().for_each(|&node| joined.join(tet[0], node));
    }
    let mut number_of_root = vec![u32::MAX; draft.nodes.len()];
    let mut found: Vec<Piece> = Vec::new();
    let mut of_tet = Vec::with_capacity(draft.tetrahedra.len());
    for tet in &draft.tetrahedra {
        let root = joined.root(tet[0]) as usize;
        if number_of_root[root] == u32::MAX {
            number_of_root[root] = found.len() as u32;
            found.push(Piece { tetrahedra: 0, volume: 0.0, centre: Vector::zeros() });
        }
        let piece = &mut found[number_of_root[root] as usize];
        let volume = draft.volume(tet);
        piece.tetrahedra += 1;
        piece.volume += volume;
        piece.centre += draft.corners(tet).iter().sum::<Vector>() * (volume / 4.0);
        of_tet.push(number_of_root[root]);
    }
    found.iter_mut().for_each(|piece| piece.centre /= piece.volume);
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|&a, &b| found[b].volume.total_cmp(&found[a].volume));
    let mut rank = vec![0; found.len()];
    order.iter().enumerate().for_each(|(place, &piece)| rank[piece] = place as u32);
    of_tet.iter_mut().for_each(|piece| *piece = rank[*piece as usize]);
    (order.into_iter().map(|piece| found[piece]).collect(), of_tet)
}

/// What is left out of a mesh.
#[derive(Default)]
pub(super) struct Dropped {
    pub pieces: Vec<Piece>,
    /// The corners of its cells.
    pub cells: Vec<[Vector; 4]>,
}

/// Leaves the largest piece; returns the others.
pub(super) fn drop_small(draft: &mut Draft) -> Dropped {
    let (mut all, of_tet) = pieces(draft);
    if all.len() < 2 {
        return Dropped::default();
    }
    let others = draft.tetrahedra.iter().zip(&of_tet).filter(|(_, piece)| **piece != 0);
    let cells = others.map(|(tet, _)| draft.corners(tet)).collect();
    draft.retain(|tet| of_tet[tet] == 0);
    Dropped { pieces: all.split_off(1), cells }
}
