//! Boxes around points.

use std::borrow::Borrow;

use super::Vector;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as ParryVector;

/// The box around no point: its lowest corner is above its highest.
pub const EMPTY_BOUNDS: [Vector; 2] = [
    Vector::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    Vector::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
];

/// The lowest and the highest corner of the box around some points; none around no point.
pub fn bounds_of<P: Borrow<Vector>>(points: impl IntoIterator<Item = P>) -> Option<[Vector; 2]> {
    let mut points = points.into_iter();
    let first = *points.next()?.borrow();
    let widened = |[low, high]: [Vector; 2], x: P| [low.inf(x.borrow()), high.sup(x.borrow())];
    Some(points.fold([first, first], widened))
}

/// Whether two boxes, each by its lowest and its highest corner, have a point in common.
pub fn boxes_meet([low, high]: &[Vector; 2], [other_low, other_high]: &[Vector; 2]) -> bool {
    (0..3).all(|axis| high[axis] >= other_low[axis] && low[axis] <= other_high[axis])
}

/// A box as the geometry library has it.
pub(super) fn parry_box([low, high]: [Vector; 2]) -> Aabb {
    Aabb::new(to_parry(&low), to_parry(&high))
}

pub(super) fn to_parry(vector: &Vector) -> ParryVector {
    ParryVector::new(vector.x, vector.y, vector.z)
}
