//! Segmentation of the head: outer air, airways, and the visible skin.

use super::mask::Mask;
use super::morphology::{dilated, eroded};
use super::pieces::{Connection, Pieces};

/// A head in the air of its scan.
#[derive(Clone, Debug, PartialEq)]
pub struct OuterSkin {
    /// All that the visible skin encloses: tissue, bone, airways.
    pub head: Mask,
    /// The largest piece of what is no air.
    pub tissue: Mask,
    /// Air within: nose, mouth, throat, sinuses.
    pub airways: Mask,
    /// Everything above the threshold that is not the head: table, head rest, bandages that stand off.
    pub other: Mask,
}

/// The head is the largest piece of what is no air. Air is outside where a ball of that radius, in mm, gets to from the
/// sides of the image without touching the head: nostrils and lips that are apart by less than its diameter stay closed.
/// The ends of the image along the body do not count as sides, because the throat is open there.
pub fn outer_skin(solid: &Mask, body_axis: usize, radius: f64) -> OuterSkin {
    let head = Pieces::of(solid, Connection::Faces).largest_mask(solid);
    let air = head.complement();
    let wide = eroded(&air, radius);
    let pieces = Pieces::of(&wide, Connection::Faces);
    let mut is_outer = vec![false; pieces.sizes.len()];
    for voxel in 0..air.inside.len() {
        if let Some(piece) = pieces.piece(voxel)
            && !is_outer[piece]
        {
            let index = air.grid.index(voxel);
            is_outer[piece] = (0..3)
                .filter(|&axis| axis != body_axis)
                .any(|axis| index[axis] == 0 || index[axis] + 1 == air.grid.size[axis]);
        }
    }
    let outside = dilated(&pieces.mask(&air, |piece| is_outer[piece]), radius).and(&air);
    let head_and_within = outside.complement();
    let other = solid.without(&head);
    let airways = head_and_within.without(&head).without(&other);
    OuterSkin { head: head_and_within, tissue: head, airways, other: other.and(&outside) }
}
