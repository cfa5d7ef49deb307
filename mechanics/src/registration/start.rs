//! The movement from which iterative closest point starts.

use nalgebra::{Matrix3, Rotation3};

use super::RigidTransform;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, area_sampling};

/// Points by which the four ways of joining principal axes are distinguished.
const POINTS: usize = 300;

/// Where the moving surface lies before the first iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Start {
    /// As it lies; where the boxes around the surfaces do not touch, with their middles together.
    #[default]
    AsItLies,
    /// The middles of the boxes together.
    Boxes,
    /// Centres and principal axes together, in the one of four ways that leaves least.
    Inertia,
    /// A given movement, such as one by landmarks.
    Known(RigidTransform),
}

impl Start {
    pub(super) fn transform(
        &self,
        fixed: &TriangleSurface,
        moving: &TriangleSurface,
        search: &SurfaceSearch,
    ) -> RigidTransform {
        match self {
            Start::AsItLies if boxes_touch(fixed, moving) => RigidTransform::identity(),
            Start::AsItLies | Start::Boxes => boxes_joined(fixed, moving),
            Start::Inertia => axes_joined(fixed, moving, search),
            Start::Known(transform) => *transform,
        }
    }
}

fn boxes_touch(fixed: &TriangleSurface, moving: &TriangleSurface) -> bool {
    let [(low, high), (moving_low, moving_high)] = [fixed, moving].map(TriangleSurface::bounds);
    (0..3).all(|axis| low[axis] <= moving_high[axis] && moving_low[axis] <= high[axis])
}

fn boxes_joined(fixed: &TriangleSurface, moving: &TriangleSurface) -> RigidTransform {
    let [(low, high), (moving_low, moving_high)] = [fixed, moving].map(TriangleSurface::bounds);
    let translation = (low + high - moving_low - moving_high) * 0.5;
    RigidTransform { translation, ..RigidTransform::identity() }
}

/// The centre of a surface and its principal axes, right-handed, the longest first.
pub(super) fn inertia(surface: &TriangleSurface) -> (Vector, Matrix3<f64>) {
    let samples = area_sampling::equal_areas(surface, POINTS);
    let origin = samples.first().map_or_else(Vector::zeros, |sample| sample.point);
    let offsets: Vec<Vector> = samples.iter().map(|sample| sample.point - origin).collect();
    let mean = offsets.iter().sum::<Vector>() / offsets.len().max(1) as f64;
    let moments = offsets.iter().map(|offset| (offset - mean) * (offset - mean).transpose());
    let modes = moments.sum::<Matrix3<f64>>().symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| modes.eigenvalues[b].total_cmp(&modes.eigenvalues[a]));
    let [first, second] = [order[0], order[1]].map(|i| modes.eigenvectors.column(i).into_owned());
    (origin + mean, Matrix3::from_columns(&[first, second, first.cross(&second)]))
}

/// What leaves every one of three axes where it was or turns it round.
pub(super) fn half_turns() -> [Matrix3<f64>; 4] {
    let axes = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z()];
    axes.map(|axis| Rotation3::new(axis * std::f64::consts::PI).into_inner())
}

fn axes_joined(
    fixed: &TriangleSurface,
    moving: &TriangleSurface,
    search: &SurfaceSearch,
) -> RigidTransform {
    let ((to, to_axes), (from, from_axes)) = (inertia(fixed), inertia(moving));
    let points = area_sampling::equal_areas(fixed, POINTS);
    let candidates = half_turns().map(|flip| {
        let rotation = to_axes * flip * from_axes.transpose();
        RigidTransform { rotation, translation: to - rotation * from }
    });
    let left = |transform: &RigidTransform| -> f64 {
        let back = transform.inverse();
        points.iter().map(|sample| search.closest(&back.apply(&sample.point)).distance).sum()
    };
    let best = candidates.into_iter().min_by(|a, b| left(a).total_cmp(&left(b)));
    best.unwrap_or_else(RigidTransform::identity)
}
