//! Holes of a mask: what is outside it and cannot be reached from the border of the image.

use rayon::prelude::*;

use super::mask::{Grid, Mask};
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

/// The mask with all that it encloses within one slice across an axis, slice by slice: a marrow cavity that opens above
/// is filled as well.
pub fn filled_in_slices(mask: &Mask, axis: usize) -> Mask {
    let Grid { size, spacing } = mask.grid;
    let [one, other] = [(axis + 1) % 3, (axis + 2) % 3];
    let grid =
        Grid { size: [size[one], size[other], 1], spacing: [spacing[one], spacing[other], 1.0] };
    let place = |slice: usize, number: usize| {
        let mut index = [0; 3];
        (index[axis], index[one], index[other]) = (slice, number % size[one], number / size[one]);
        mask.grid.number(index)
    };
    let slices: Vec<Mask> = (0..size[axis])
        .into_par_iter()
        .map(|slice| {
            let inside = (0..grid.len()).map(|number| mask.inside[place(slice, number)]).collect();
            filled(&Mask { grid, inside })
        })
        .collect();
    let mut inside = mask.inside.clone();
    for (slice, filled) in slices.iter().enumerate() {
        for (number, &is_inside) in filled.inside.iter().enumerate() {
            inside[place(slice, number)] = is_inside;
        }
    }
    Mask { grid: mask.grid, inside }
}
