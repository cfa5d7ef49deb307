//! Intersection of a line and a triangle.

use crate::mesh::Vector;

/// Weights of corners may be this far below 0: the rim of a triangle belongs to it.
const RIM: f64 = -0.02;

/// A line this near to the plane of a triangle, as the sine of the angle between them, does not meet it.
const ALONG: f64 = 1e-3;

/// A point of a triangle on a line.
pub(super) struct Meeting {
    /// Of the corners; their sum is 1.
    pub weights: [f64; 3],
    /// How far along the line, in mm.
    pub ahead: f64,
}

/// The meeting of a triangle and the line through a point along a unit vector, if there is one.
pub(super) fn meeting([a, b, c]: &[Vector; 3], at: &Vector, along: &Vector) -> Option<Meeting> {
    let normal = (b - a).cross(&(c - a));
    let slope = normal.dot(along);
    let square = normal.norm_squared();
    if slope.abs() <= ALONG * square.sqrt() {
        return None;
    }
    let ahead = normal.dot(&(a - at)) / slope;
    let met = at + along * ahead;
    let second = normal.dot(&(met - a).cross(&(c - a))) / square;
    let third = normal.dot(&(b - a).cross(&(met - a))) / square;
    let weights = [1.0 - second - third, second, third];
    if weights.iter().any(|weight| *weight < RIM) {
        return None;
    }
    let inside = weights.map(|weight| weight.max(0.0));
    let sum: f64 = inside.iter().sum();
    Some(Meeting { weights: inside.map(|weight| weight / sum), ahead })
}
