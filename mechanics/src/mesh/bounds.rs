//! Boxes around points.

use std::borrow::Borrow;

use super::Vector;

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
