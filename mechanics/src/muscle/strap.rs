//! Axes of strap muscles from the box of their closed surface.
//!
//! The longest axis of a box is that of the fibres of a strap only. Triangles count by their area, so that vertices that crowd in
//! a corner turn nothing; a curved muscle is divided in the middle of its length into two boxes, or four.

use nalgebra::Matrix3;

use super::axis::principal;
use crate::mesh::{TriangleSurface, Vector};

/// Above this ratio of the second to the first standard deviation a muscle is no strap: of the muscles of a face the buccinator,
/// the depressor labii, the mentalis and both parts of the orbicularis oris are above, and their boxes lie across their fibres
/// by up to 79 degrees.
pub const BROAD: f64 = 0.4;

/// One box of a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrapBox {
    pub centre: Vector,
    /// Of length 1, sign free.
    pub axis: Vector,
}

/// The boxes of a muscle from one end to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Strap {
    pub boxes: Vec<StrapBox>,
    /// Of the second to the first standard deviation of the whole surface.
    pub broadness: f64,
}

impl Strap {
    /// Whether the axis of its box may lie across its fibres.
    pub fn is_broad(&self) -> bool {
        self.broadness > BROAD
    }

    /// The axis of the nearest box.
    pub fn axis_at(&self, place: &Vector) -> Option<Vector> {
        let apart = |own: &StrapBox| (own.centre - place).norm_squared();
        self.boxes.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).map(|own| own.axis)
    }
}

/// The boxes of a surface in mm, halved `halvings` times (0 to 2); nothing of a surface without area.
pub fn strap_of(surface: &TriangleSurface, halvings: usize) -> Option<Strap> {
    let corners = |triangle: &[u32; 3]| triangle.map(|corner| surface.points[corner as usize]);
    let whole: Vec<[Vector; 3]> = surface.triangles.iter().map(corners).collect();
    let (centre, moments) = moments(&whole)?;
    let (values, axes) = principal(&moments);
    let broadness = (values[1].max(0.0) / values[0]).sqrt();
    let mut boxes = vec![StrapBox { centre, axis: axes[0] }];
    let mut parts = vec![whole];
    for _ in 0..halvings.min(2) {
        let halves = parts.iter().zip(&boxes).flat_map(|(part, own)| halved(part, own));
        parts = halves.collect();
        let found: Vec<StrapBox> = parts.iter().filter_map(|part| box_of(part)).collect();
        boxes = found;
    }
    Some(Strap { boxes, broadness })
}

/// The closed surface of a box from its centre and the ways to the middles of three of its faces, facing outwards.
pub fn box_surface(centre: Vector, [a, b, c]: [Vector; 3]) -> TriangleSurface {
    let corner = |number: u32| {
        let side = |bit: u32| if number >> bit & 1 == 1 { 1.0 } else { -1.0 };
        centre + a * side(0) + b * side(1) + c * side(2)
    };
    // Around each face seen from outside, where a, b and c are right-handed.
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let is_right_handed = a.dot(&b.cross(&c)) > 0.0;
    let halves = faces.iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]);
    let facing = |[p, q, r]: [u32; 3]| if is_right_handed { [p, q, r] } else { [p, r, q] };
    TriangleSurface {
        points: (0..8).map(corner).collect(),
        triangles: halves.map(facing).collect(),
        ..TriangleSurface::default()
    }
}

fn box_of(triangles: &[[Vector; 3]]) -> Option<StrapBox> {
    let (centre, moments) = moments(triangles)?;
    Some(StrapBox { centre, axis: principal(&moments).1[0] })
}

/// The triangles on either side of the centre across the axis, those without area left out.
fn halved(triangles: &[[Vector; 3]], own: &StrapBox) -> [Vec<[Vector; 3]>; 2] {
    let is_before = |triangle: &[Vector; 3]| {
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        (middle - own.centre).dot(&own.axis) < 0.0
    };
    let (before, after) = triangles.iter().copied().partition(is_before);
    [before, after]
}

/// The centre of a surface and its second moments of area about it, over its area.
fn moments(triangles: &[[Vector; 3]]) -> Option<(Vector, Matrix3<f64>)> {
    let area = |[a, b, c]: &[Vector; 3]| (b - a).cross(&(c - a)).norm() / 2.0;
    let total: f64 = triangles.iter().map(area).sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let middle = |[a, b, c]: &[Vector; 3]| (a + b + c) / 3.0;
    let centre = triangles.iter().map(|own| middle(own) * area(own)).sum::<Vector>() / total;
    let of = |own: &[Vector; 3]| {
        let from = middle(own) - centre;
        let corners = own.iter().map(|x| (x - centre) * (x - centre).transpose());
        (corners.sum::<Matrix3<f64>>() + from * from.transpose() * 9.0) * (area(own) / 12.0)
    };
    Some((centre, triangles.iter().map(of).sum::<Matrix3<f64>>() / total))
}
