//! The movements of bone that an operation performed, from bone before and after it.
//!
//! T takes the scan after the operation to the one before it by bone that nothing was done to, and S_k takes it to
//! where segment k lay before. So the segment went from x to T S_k⁻¹ x, in the frame before the operation.
//! Both by iterative closest point with a mask and a limit on what counts, since cuts, plates and grown bone have no
//! partner. Source: Kim et al. 2012, section 2.6: each segment by itself, after the skull base
//! (docs/methods.md#registration).

use rayon::prelude::*;

use super::closest_point::SurfaceAlignment;
use super::masked_points::points_in_mask;
use super::{
    AlignmentError, IterativeClosestPoint, RigidTransform, SphereOrBox, StandardError, Start,
};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::progress::Progress;

/// Bone before the operation that decides, and where its search starts.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneBefore<'a> {
    pub surface: &'a TriangleSurface,
    /// Only the part in it decides.
    pub mask: Option<SphereOrBox>,
    /// Takes the scan after the operation to this bone.
    pub start: Start,
}

/// Performed movement of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Performed {
    /// x' = R x + t in the frame before the operation, in mm.
    pub movement: RigidTransform,
    /// How well the segment before the operation lies on the bone after it.
    pub fit: SurfaceAlignment,
    /// The rotation in radians between the start of its search and where it was found.
    pub turned_from_start: f64,
    /// Of the movement of the segment, by base and segment together; nothing where the shape of one leaves a movement free.
    pub standard_error: Option<StandardError>,
    /// Of the segment before the operation, in mm.
    pub centre: Vector,
}

/// The scan after the operation onto the one before it, by bone that nothing was done to.
pub fn align_base(
    base: &BoneBefore,
    after: &TriangleSurface,
    progress: &dyn Progress,
) -> Result<SurfaceAlignment, AlignmentError> {
    fit(base, after, progress)
}

/// Beyond this share of the base farther than [`FAR`](super::closest_point::FAR) from its partner, other starts are tried: bone that was
/// not operated on leaves a tenth of it.
const MUCH_FAR: f64 = 0.05;

/// Another start is taken where it leaves less than this share of the median distance: the same place found again leaves as much.
const MUCH_NEARER: f64 = 0.5;

/// The same where no start is stated, and the start from which it was found: as the scans lie. If that finds nothing or leaves much of the
/// base far, also from the boxes and from the principal axes of both scans; of these three the one after which half of the base is
/// nearest to the bone after the operation.
pub fn align_base_from_any(
    base: &BoneBefore,
    after: &TriangleSurface,
    progress: &dyn Progress,
) -> Result<(SurfaceAlignment, Start), AlignmentError> {
    let from = |start| fit(&BoneBefore { start, ..base.clone() }, after, progress);
    let as_it_lies = from(Start::AsItLies);
    let (mut least, mut best) = match &as_it_lies {
        Ok(found) if found.share_far <= MUCH_FAR => return Ok((*found, Start::AsItLies)),
        Ok(found) => (MUCH_NEARER * left(base, after, found)?, Some((*found, Start::AsItLies))),
        Err(AlignmentError::NoOverlap { .. } | AlignmentError::NotConverged { .. }) => {
            (f64::INFINITY, None)
        }
        Err(_) => return as_it_lies.map(|found| (found, Start::AsItLies)),
    };
    for start in [Start::Boxes, Start::Inertia] {
        let found = match from(start) {
            Err(stopped @ AlignmentError::Cancelled { .. }) => return Err(stopped),
            Err(_) => continue,
            Ok(found) => found,
        };
        let distance = left(base, after, &found)?;
        if distance < least {
            (least, best) = (distance, Some((found, start)));
        }
    }
    match best {
        Some(best) => Ok(best),
        None => as_it_lies.map(|found| (found, Start::AsItLies)),
    }
}

/// The median distance in mm of the base from the bone after the operation, once that is registered.
fn left(
    base: &BoneBefore,
    after: &TriangleSurface,
    found: &SurfaceAlignment,
) -> Result<f64, AlignmentError> {
    median_distance(base, after, &found.transform.inverse())
}

/// The movement of one segment. A start as the surfaces lie is that of the base.
pub fn performed(
    segment: &BoneBefore,
    after: &TriangleSurface,
    base: &SurfaceAlignment,
    progress: &dyn Progress,
) -> Result<Performed, AlignmentError> {
    let start = match segment.start {
        Start::AsItLies => Start::Known(base.transform),
        other => other,
    };
    let fit = fit(&BoneBefore { start, ..segment.clone() }, after, progress)?;
    let movement = fit.transform.inverse().then(&base.transform);
    let started = match start {
        Start::Known(transform) => transform,
        Start::AsItLies | Start::Boxes | Start::Inertia => base.transform,
    };
    let turned_from_start = fit.transform.inverse().then(&started).angle();
    let standard_error = standard_error(segment, base, &fit, &movement)?;
    Ok(Performed { movement, fit, turned_from_start, standard_error, centre: centre(segment) })
}

/// Both registrations are off independently of each other.
fn standard_error(
    segment: &BoneBefore,
    base: &SurfaceAlignment,
    own: &SurfaceAlignment,
    movement: &RigidTransform,
) -> Result<Option<StandardError>, AlignmentError> {
    let (Some(base), Some(own)) = (base.uncertainty, own.uncertainty) else { return Ok(None) };
    let points = points_in_mask(segment.surface, segment.mask.as_ref(), POINTS)?;
    let of =
        |point: &Vector| own.displacement(point).hypot(base.displacement(&movement.apply(point)));
    Ok(Some(StandardError {
        rotation: own.rotation().hypot(base.rotation()),
        displacement: points.iter().map(of).fold(0.0, f64::max),
    }))
}

/// Points on bone that tell how far it lies from another.
const POINTS: usize = 1000;

/// The median distance in mm of bone from a surface, where `from` takes the bone to that surface; nothing is aligned.
/// Cut faces of a segment, which lie in bone that was whole, do not decide a median.
pub fn median_distance(
    bone: &BoneBefore,
    surface: &TriangleSurface,
    from: &RigidTransform,
) -> Result<f64, AlignmentError> {
    let points = points_in_mask(bone.surface, bone.mask.as_ref(), POINTS)?;
    let search = SurfaceSearch::new(surface)?;
    let mut distances: Vec<f64> =
        points.par_iter().map(|point| search.closest(&from.apply(point)).distance).collect();
    distances.sort_unstable_by(f64::total_cmp);
    Ok(distances[distances.len() / 2])
}

/// In mm: bone no farther than that from a surface is bone of that surface.
const SAME_BONE: f64 = 0.05;

/// The share of bone that is also other bone, on its surface and in its mask, 0 to 1.
pub fn share_in_common(bone: &BoneBefore, other: &BoneBefore) -> Result<f64, AlignmentError> {
    let points = points_in_mask(bone.surface, bone.mask.as_ref(), POINTS)?;
    let (low, high) = other.surface.bounds();
    let margin = Vector::repeat(SAME_BONE);
    let reach = SphereOrBox::Box { lower: low - margin, upper: high + margin };
    let may_be =
        |point: &Vector| reach.holds(point) && other.mask.is_none_or(|mask| mask.holds(point));
    let near: Vec<&Vector> = points.iter().filter(|point| may_be(point)).collect();
    if near.is_empty() {
        return Ok(0.0);
    }
    let search = SurfaceSearch::new(other.surface)?;
    let is_same = |point: &&&Vector| search.closest(point).distance <= SAME_BONE;
    Ok(near.par_iter().filter(is_same).count() as f64 / points.len() as f64)
}

fn fit(
    bone: &BoneBefore,
    after: &TriangleSurface,
    progress: &dyn Progress,
) -> Result<SurfaceAlignment, AlignmentError> {
    let (mask, start) = (bone.mask, bone.start);
    let method = IterativeClosestPoint { mask, start, ..IterativeClosestPoint::default() };
    method.align(bone.surface, after, progress)
}

/// The middle of the triangles in the mask, by their areas.
fn centre(bone: &BoneBefore) -> Vector {
    let (mut sum, mut area) = (Vector::zeros(), 0.0);
    for triangle in 0..bone.surface.triangles.len() {
        let [a, b, c] = bone.surface.corners(triangle);
        let middle = (a + b + c) / 3.0;
        if bone.mask.is_none_or(|mask| mask.holds(&middle)) {
            let weight = bone.surface.area_vector(triangle).norm();
            (sum, area) = (sum + middle * weight, area + weight);
        }
    }
    if area > 0.0 { sum / area } else { sum }
}
