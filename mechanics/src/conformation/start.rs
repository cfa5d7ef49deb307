//! Where a conformation starts: a similarity by landmarks, principal axes or boxes.

use nalgebra::{Matrix3, Rotation3};

use super::affine::Affine;
use super::landmark::spread;
use super::matching::Target;
use crate::mesh::{TriangleSurface, Vector, area_sampling};

/// Points by which axes are found, and the four ways of joining them distinguished.
const POINTS: usize = 400;

/// How the template is first brought to the patient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// Landmarks where there are three or more, principal axes of the skins otherwise.
    #[default]
    Auto,
    Landmarks,
    /// Centres and principal axes together, in the one of four ways that leaves least.
    Inertia,
    /// Middles and sizes of boxes together; nothing is turned.
    Boxes,
}

/// Middles of the boxes together, scaled by their diagonals.
pub(super) fn by_boxes(template: &TriangleSurface, patient: &TriangleSurface) -> Affine {
    let [(low, high), (to_low, to_high)] = [template, patient].map(TriangleSurface::bounds);
    let scale = (to_high - to_low).norm() / (high - low).norm();
    let matrix = Matrix3::identity() * scale;
    Affine { matrix, shift: (to_low + to_high) * 0.5 - matrix * (low + high) * 0.5 }
}

/// Centres, sizes and principal axes together; of the four ways to join axes the one that leaves least, and of these and the boxes
/// where those may do too: of parts of a head, axes differ more than boxes.
pub(super) fn by_inertia(
    template: &TriangleSurface,
    patient: &TriangleSurface,
    target: &Target,
    or_boxes: bool,
) -> Affine {
    let [from, to] = [template, patient].map(samples);
    let [(from_middle, from_size), (to_middle, to_size)] = [&from, &to].map(|x| spread(x));
    let [from_axes, to_axes] = [axes(&from, &from_middle), axes(&to, &to_middle)];
    let flips = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z()];
    let candidates = flips.map(|axis| {
        let flip = Rotation3::new(axis * std::f64::consts::PI);
        let matrix = to_axes * flip.matrix() * from_axes.transpose() * (to_size / from_size);
        Affine { matrix, shift: to_middle - matrix * from_middle }
    });
    let left = |map: &Affine| -> f64 {
        let moved: Vec<Vector> = from.iter().map(|point| map.apply(point)).collect();
        target.distances(&moved).iter().sum()
    };
    let boxes = or_boxes.then(|| by_boxes(template, patient));
    let best = candidates.into_iter().chain(boxes).min_by(|a, b| left(a).total_cmp(&left(b)));
    best.unwrap_or_else(Affine::identity)
}

fn samples(surface: &TriangleSurface) -> Vec<Vector> {
    area_sampling::equal_areas(surface, POINTS).into_iter().map(|sample| sample.point).collect()
}

/// Principal axes, right-handed, the longest first.
fn axes(points: &[Vector], middle: &Vector) -> Matrix3<f64> {
    let moments = points.iter().map(|point| (point - middle) * (point - middle).transpose());
    let modes = moments.sum::<Matrix3<f64>>().symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| modes.eigenvalues[b].total_cmp(&modes.eigenvalues[a]));
    let [first, second] = [order[0], order[1]].map(|i| modes.eigenvectors.column(i).into_owned());
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}
