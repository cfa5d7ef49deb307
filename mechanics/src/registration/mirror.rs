//! Detection of mirror images: whether one surface looks like the mirrored other one.
//!
//! A scan exported with one axis reversed is a face still, and aligns with a plausible error. So the
//! moving surface is also mirrored at each of its three principal planes and aligned from there; the
//! best of the three is set against the alignment without a mirror.

use nalgebra::Matrix3;

use super::closest_point::{StopRule, iterate, points_in_mask};
use super::{AlignmentError, Place, RigidTransform};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, area_sampling};
use crate::progress::Unobserved;

const POINTS: usize = 1000;
const STOP: StopRule = StopRule { relative_change: 1e-3, max_iterations: 40 };

/// A mirror image has to fit this much better.
const MUCH_BETTER: f64 = 0.5;

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
    mask: Option<&Place>,
    start: &RigidTransform,
) -> Result<MirrorCheck, AlignmentError> {
    let points = points_in_mask(fixed, mask, POINTS)?;
    let search = SurfaceSearch::new(moving)?;
    let plain = iterate(&points, &search, *start, &STOP, &Unobserved)?.alignment;
    let mut mirrored_rms = f64::INFINITY;
    for mirror in mirrors(moving) {
        let start = mirror.then(start);
        // A mirror image that lies nowhere near is no better, and no error.
        let Ok(ended) = iterate(&points, &search, start, &STOP, &Unobserved) else { continue };
        // Few close pairs at a border would fit any shape.
        if 10 * ended.alignment.pairs >= 8 * plain.pairs {
            mirrored_rms = mirrored_rms.min(ended.alignment.rms);
        }
    }
    Ok(MirrorCheck { rms: plain.rms, mirrored_rms })
}

/// Reflections at the planes through the middle of a surface, across its principal axes.
fn mirrors(surface: &TriangleSurface) -> [RigidTransform; 3] {
    let samples = area_sampling::equal_areas(surface, POINTS);
    let origin = samples.first().map_or_else(Vector::zeros, |sample| sample.point);
    let offsets: Vec<Vector> = samples.iter().map(|sample| sample.point - origin).collect();
    let mean = offsets.iter().sum::<Vector>() / offsets.len().max(1) as f64;
    let mut moments = Matrix3::zeros();
    for offset in &offsets {
        moments += (offset - mean) * (offset - mean).transpose();
    }
    let axes = moments.symmetric_eigen().eigenvectors;
    [0, 1, 2].map(|axis| {
        let normal = axes.column(axis).into_owned();
        let reflection = Matrix3::identity() - normal * normal.transpose() * 2.0;
        RigidTransform::about(&(origin + mean), reflection, Vector::zeros())
    })
}
