//! Holes of a mask: what is outside it and cannot be reached from the border of the image.

use super::mask::Mask;
use super::pieces::{Connection, Pieces};

/// The mask with all that it encloses.
pub fn filled(mask: &Mask) -> Mask {
    let outside = mask.complement();
    let pieces = Pieces::of(&outside, Connection::Faces);
    let mut is_open = vec![false; pieces.sizes.len()];
    for voxel in 0..mask.inside.len() {
        if let Some(piece) = pieces.piece(voxel)
            && !is_open[piece]
        {
            is_open[piece] = mask.grid.is_border(mask.grid.index(voxel));
        }
    }
    pieces.mask(&outside, |piece| !is_open[piece]).or(mask)
}
