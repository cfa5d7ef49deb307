//! Duplicate sheets of a surface: of two pieces close beside each other the smaller one is left out.
//!
//! Where the sheets cross, the winding number would bound a body by whichever lies farther out, and that is neither of the two.

use super::facets::Pieces;
use super::triangle::Corners;
use super::triangle_tree::{Facet, TriangleTree};
use crate::mesh::Vector;

/// How far a sheet may be from the other, in diagonals of the surface's box.
const BESIDE: f64 = 5e-3;
/// Volumes and areas of the two are the same but for this part.
const ALIKE: f64 = 0.1;
/// A piece of less of the area is too little to matter.
const LEAST_AREA: f64 = 0.01;
/// Triangles of a piece that are looked at.
const LOOKED_AT: usize = 400;

/// Duplicate sheets.
#[derive(Clone, Debug, Default)]
pub(super) struct SecondSheets {
    /// Triangles to be left out, ascending.
    pub triangles: Vec<u32>,
    /// By how much the volumes of each two differ, together, in mm³.
    pub differ: f64,
}

#[derive(Clone, Copy, Default)]
struct Piece {
    area: f64,
    /// Six times as much as it encloses.
    volume: f64,
    first: u32,
    count: usize,
}

/// Of triangles that are turned already.
pub(super) fn second_sheets(corners: &[Corners], pieces: &Pieces) -> SecondSheets {
    let mut found = SecondSheets::default();
    let sizes = sizes(corners, pieces);
    let area: f64 = sizes.iter().map(|piece| piece.area).sum();
    let is_large = |piece: &Piece| piece.area >= LEAST_AREA * area;
    let mut large: Vec<u32> =
        (0..sizes.len() as u32).filter(|&n| is_large(&sizes[n as usize])).collect();
    if large.len() < 2 {
        return found;
    }
    large.sort_by(|&a, &b| {
        let volume = |n: u32| sizes[n as usize].volume.abs();
        volume(b).total_cmp(&volume(a)).then(a.cmp(&b))
    });
    let facet =
        |(n, &corners): (usize, &Corners)| Facet { corners, number: n as u32, open: [0.0; 3] };
    let tree = TriangleTree::new(corners.iter().enumerate().map(facet).collect());
    let (low, high) = tree.bounds();
    let sheets =
        Sheets { corners, pieces, sizes: &sizes, tree: &tree, reach: (high - low).norm() * BESIDE };
    let mut second = vec![false; sizes.len()];
    for (n, &first) in large.iter().enumerate() {
        let other = large[n + 1..].iter().copied().find(|&other| {
            !second[first as usize]
                && !second[other as usize]
                && sheets.are_coincident([first, other])
        });
        if let Some(other) = other {
            second[other as usize] = true;
            found.differ +=
                (sizes[first as usize].volume - sizes[other as usize].volume).abs() / 6.0;
        }
    }
    let each = pieces.piece_of.iter().enumerate();
    let left_out = each.filter(|(_, piece)| second[**piece as usize]).map(|(n, _)| n as u32);
    found.triangles = left_out.collect();
    found
}

fn sizes(corners: &[Corners], pieces: &Pieces) -> Vec<Piece> {
    let middle = corners.iter().map(Corners::middle).sum::<Vector>() / corners.len().max(1) as f64;
    let mut sizes = vec![Piece::default(); pieces.count];
    for (n, (&piece, corners)) in pieces.piece_of.iter().zip(corners).enumerate() {
        let own = &mut sizes[piece as usize];
        if own.count == 0 {
            own.first = n as u32;
        }
        own.count += 1;
        own.area += corners.area_vector().norm();
        own.volume += corners.volume_with(&middle);
    }
    sizes
}

struct Sheets<'a> {
    corners: &'a [Corners],
    pieces: &'a Pieces,
    sizes: &'a [Piece],
    tree: &'a TriangleTree,
    /// In mm.
    reach: f64,
}

impl Sheets<'_> {
    fn are_coincident(&self, [a, b]: [u32; 2]) -> bool {
        let of = |piece: u32| self.sizes[piece as usize];
        let alike = |a: f64, b: f64| a * b > 0.0 && (a - b).abs() <= ALIKE * a.abs().max(b.abs());
        alike(of(a).area, of(b).area)
            && alike(of(a).volume, of(b).volume)
            && self.lies_along(of(a).first as usize, b)
            && self.all_along(a, b)
            && self.all_along(b, a)
    }

    fn all_along(&self, piece: u32, other: u32) -> bool {
        let members = self.pieces.piece_of.iter().enumerate().filter(|(_, of)| **of == piece);
        let apart = self.sizes[piece as usize].count.div_ceil(LOOKED_AT);
        members.step_by(apart).all(|(n, _)| self.lies_along(n, other))
    }

    /// Whether a piece lies close beside a triangle.
    fn lies_along(&self, triangle: usize, piece: u32) -> bool {
        let of_piece = |number: u32| self.pieces.piece_of[number as usize] == piece;
        let nearest = self.tree.nearest(&self.corners[triangle].middle(), of_piece);
        nearest.is_some_and(|nearest| nearest.distance <= self.reach)
    }
}
