//! Hollows of a surface: what closed pieces enclose that lie in another piece and face into it, such as the wall of marrow or the
//! inner side of a closed skull.
//!
//! Nothing leads out of them, so that no tissue in them hangs together with the skin. As long as their walls are there, a wall
//! thinner than a cell is lost in a mesh, and what it encloses becomes tissue.

use super::facets::Edges;
use super::triangle::Corners;
use crate::mesh::Vector;

/// What a wall encloses inside bone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hollow {
    /// In mm³.
    pub volume: f64,
    /// The mean place of its wall, in mm.
    pub centre: Vector,
}

/// The hollows of a surface, the largest first, and the triangles of their walls.
#[derive(Clone, Debug, Default)]
pub(super) struct Hollows {
    pub list: Vec<Hollow>,
    /// By their place among the triangles, ascending.
    pub walls: Vec<usize>,
}

/// What a piece of a surface sums to.
#[derive(Clone, Copy, Default)]
struct Piece {
    is_open: bool,
    area: f64,
    /// Six times its volume, negative where it faces inwards.
    volume: f64,
    /// Its middles by their areas.
    middle: Vector,
}

/// Of mended triangles, each on its side: closed pieces inside out that lie in no other have been turned.
pub(super) fn hollows(corners: &[Corners], edges: &Edges, open: &[[f64; 3]]) -> Hollows {
    let pieces = edges.pieces();
    let mut all = vec![Piece::default(); pieces.count];
    for ((corners, open), &piece) in corners.iter().zip(open).zip(&pieces.piece_of) {
        let piece = &mut all[piece as usize];
        let area = corners.area_vector().norm();
        piece.is_open |= *open != [0.0; 3];
        piece.area += area;
        piece.middle += corners.middle() * area;
    }
    for piece in &mut all {
        piece.middle /= piece.area.max(f64::MIN_POSITIVE);
    }
    for (corners, &piece) in corners.iter().zip(&pieces.piece_of) {
        let piece = &mut all[piece as usize];
        piece.volume += corners.volume_with(&piece.middle);
    }
    let is_wall = |piece: &Piece| !piece.is_open && piece.volume < 0.0;
    let hollow = |piece: &Piece| Hollow { volume: -piece.volume / 6.0, centre: piece.middle };
    let mut list: Vec<Hollow> = all.iter().filter(|piece| is_wall(piece)).map(hollow).collect();
    list.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    let numbered = pieces.piece_of.iter().enumerate();
    let walls = numbered.filter(|(_, piece)| is_wall(&all[**piece as usize]));
    Hollows { list, walls: walls.map(|(number, _)| number).collect() }
}
