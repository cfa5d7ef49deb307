//! Detection of mirror images: whether one surface looks like the mirrored other one.
//!
//! A scan exported with one axis reversed is a face still, and aligns with a plausible error. So the
//! moving surface is also mirrored at its principal planes, and onto those of the other, and aligned from there; the
//! best of them is set against the alignment without a mirror.

use nalgebra::Matrix3;

use super::closest_point::{StopRule, SurfaceAlignment, iterate};
use super::masked_points::points_in_mask;
use super::start::{half_turns, inertia};
use super::{AlignmentError, RigidTransform, SphereOrBox};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::progress::Unobserved;

const POINTS: usize = 1000;
const STOP: StopRule = StopRule { relative_change: 1e-3, max_iterations: 40 };

/// A face is nearly its own mirror image: which fits better is seen at the end only.
const END: StopRule = StopRule { relative_change: 1e-5, max_iterations: 200 };

/// A mirror image has to fit this much better.
const MUCH_BETTER: f64 = 0.7;

/// In mm: below, the surfaces fit well enough as they are.
const FITS: f64 = 0.1;

/// How well the surfaces fit, in mm, without and with a mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorCheck {
    pub rms: f64,
    pub mirrored_rms: f64,
}

impl MirrorCheck {
    pub fn looks_mirrored(&self) -> bool {
        self.rms > FITS && self.mirrored_rms < MUCH_BETTER * self.rms
    }
}

/// Aligns from `start`, which takes `moving` to `fixed`, and from its three mirror images.
pub fn check_mirror(
    fixed: &TriangleSurface,
    moving: &TriangleSurface,
    mask: Option<&SphereOrBox>,
    start: &RigidTransform,
) -> Result<MirrorCheck, AlignmentError> {
    let points = points_in_mask(fixed, mask, POINTS)?;
    let search = SurfaceSearch::new(moving)?;
    let plain = iterate(&points, &search, *start, &END, &Unobserved)?.alignment;
    // A mirror image that lies nowhere near is no better, and no error.
    let ended =
        |from, stop| Some(iterate(&points, &search, from, stop, &Unobserved).ok()?.alignment);
    // Few close pairs at a border would fit any shape.
    let is_alike = |other: &SurfaceAlignment| 10 * other.pairs >= 8 * plain.pairs;
    let near = starts(fixed, moving, start).into_iter().filter_map(|from| ended(from, &STOP));
    let best = near.filter(is_alike).min_by(|a, b| a.rms.total_cmp(&b.rms));
    let mirrored = best.and_then(|best| ended(best.transform, &END)).filter(is_alike);
    let mirrored_rms = mirrored.map_or(f64::INFINITY, |mirrored| mirrored.rms);
    Ok(MirrorCheck { rms: plain.rms, mirrored_rms })
}

/// Reflections of the moving surface: at the planes through its middle across its principal axes, from there as without a
/// mirror; and with its principal axes on those of the fixed one.
fn starts(
    fixed: &TriangleSurface,
    moving: &TriangleSurface,
    start: &RigidTransform,
) -> Vec<RigidTransform> {
    let ((to, to_axes), (from, from_axes)) = (inertia(fixed), inertia(moving));
    let across = (0..3).map(|axis| {
        let normal = from_axes.column(axis).into_owned();
        let reflection = Matrix3::identity() - normal * normal.transpose() * 2.0;
        RigidTransform::about(&from, reflection, Vector::zeros()).then(start)
    });
    let joined = half_turns().map(|turn| {
        let reflection = -to_axes * turn * from_axes.transpose();
        RigidTransform::about(&from, reflection, to - from)
    });
    across.chain(joined).collect()
}
