//! Points spread over the part of a surface in a mask.

use super::{AlignmentError, SphereOrBox};
use crate::mesh::area_sampling::{self, AreaSample};
use crate::mesh::{TriangleSurface, Vector};

/// About `count` points spread over the part of a surface in the mask.
pub(super) fn points_in_mask(
    surface: &TriangleSurface,
    mask: Option<&SphereOrBox>,
    count: usize,
) -> Result<Vec<Vector>, AlignmentError> {
    samples_in_mask(surface, mask, count).map(places)
}

pub(super) fn places(samples: Vec<AreaSample>) -> Vec<Vector> {
    samples.into_iter().map(|sample| sample.point).collect()
}

/// The same, all of one area; at least one.
pub(super) fn samples_in_mask(
    surface: &TriangleSurface,
    mask: Option<&SphereOrBox>,
    count: usize,
) -> Result<Vec<AreaSample>, AlignmentError> {
    /// Small masks are found on a denser sampling, up to this many times as dense.
    const DENSER: usize = 64;
    let mut total = count;
    loop {
        let mut samples = area_sampling::equal_areas(surface, total);
        samples.retain(|sample| mask.is_none_or(|mask| mask.holds(&sample.point)));
        if 2 * samples.len() >= count || total >= count * DENSER {
            return if samples.is_empty() { Err(AlignmentError::EmptyMask) } else { Ok(samples) };
        }
        let missing = count.div_ceil(samples.len().max(1)).clamp(2, 8);
        total = (total * missing).min(count * DENSER);
    }
}
