//! Dilation, erosion, closing and opening of a mask by a ball in mm.
//!
//! By the exact distance transform, so that the cost does not grow with the ball and the ball is one on any voxels.
//! Beyond the border of the image there is nothing: neither tissue nor air.

use rayon::prelude::*;

use super::distance::squared_distance;
use super::mask::Mask;

/// Voxels within the radius of the mask.
pub fn dilated(mask: &Mask, radius: f64) -> Mask {
    let near = near(mask, radius);
    Mask { grid: mask.grid, inside: near }
}

/// Voxels of the mask with nothing of its complement within the radius.
pub fn eroded(mask: &Mask, radius: f64) -> Mask {
    dilated(&mask.complement(), radius).complement()
}

/// Fills gaps and holes that no ball of this radius fits into.
pub fn closed(mask: &Mask, radius: f64) -> Mask {
    eroded(&dilated(mask, radius), radius).or(mask)
}

/// Takes away what no ball of this radius fits into.
pub fn opened(mask: &Mask, radius: f64) -> Mask {
    dilated(&eroded(mask, radius), radius).and(mask)
}

fn near(mask: &Mask, radius: f64) -> Vec<bool> {
    // Rounded like the distances themselves.
    let within = (radius * radius * (1.0 + 1e-6)) as f32;
    squared_distance(mask).into_par_iter().map(|squared| squared <= within).collect()
}
