//! Whether one surface lies within a bound of another, everywhere and not at points alone.
//!
//! A triangle of the one is halved until each piece is known to lie within the bound: the distance from a convex body is
//! convex, so that a piece is as near to a triangle of the other as its corners are; and no distance changes by more than the
//! way to a corner. Pieces that are smaller than a share of the bound count by their corners.
//! Source: Guthe, Borodin, Klein, Fast and accurate Hausdorff distance calculation between meshes, Journal of WSCG 13 (2005).

use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;
use rayon::prelude::*;

use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Sides of pieces that are not halved any more, as a share of the bound.
const SMALLEST: f64 = 1.0 / 32.0;

/// What pieces that small may be farther than their corners, as a share of the bound: their side over the root of 3.
pub(super) const BETWEEN: f64 = 0.02;

/// A place of one surface and the nearest of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    /// The triangle of the first surface on which the place is.
    pub from: u32,
    pub place: Vector,
    pub to: u32,
    pub nearest: Vector,
    pub distance: f64,
}

/// The farthest place of each triangle that is found beyond the bound.
pub(super) fn beyond(
    from: &TriangleSurface,
    to: &TriangleSurface,
    search: &SurfaceSearch,
    bound: f64,
) -> Vec<Apart> {
    let numbers = (0..from.triangles.len() as u32).into_par_iter().with_min_len(64);
    numbers.filter_map(|number| Pieces { number, to, search, bound }.farthest(from)).collect()
}

/// The pieces of one triangle.
struct Pieces<'a> {
    number: u32,
    to: &'a TriangleSurface,
    search: &'a SurfaceSearch,
    bound: f64,
}

impl Pieces<'_> {
    fn farthest(&self, from: &TriangleSurface) -> Option<Apart> {
        let whole = from.corners(self.number as usize).map(|corner| self.at(corner));
        let mut open = vec![whole];
        let mut worst: Option<Apart> = None;
        while let Some(piece) = open.pop() {
            let [a, b, c] = piece;
            let far = [a, b, c].into_iter().max_by(|x, y| x.distance.total_cmp(&y.distance))?;
            if far.distance > self.bound {
                worst = worst.filter(|worst| worst.distance >= far.distance).or(Some(far));
                continue;
            }
            let sides = [(b, c, a), (c, a, b), (a, b, c)];
            let length = |side: &(Apart, Apart, Apart)| (side.0.place - side.1.place).norm();
            let longest = sides.into_iter().max_by(|x, y| length(x).total_cmp(&length(y)))?;
            let side = length(&longest);
            let is_within = far.distance + side / 3.0_f64.sqrt() <= self.bound;
            if is_within || side <= SMALLEST * self.bound || self.is_near_one(&piece) {
                continue;
            }
            let (one, other, opposite) = longest;
            let middle = self.at((one.place + other.place) * 0.5);
            open.extend([[one, middle, opposite], [middle, other, opposite]]);
        }
        worst
    }

    fn at(&self, place: Vector) -> Apart {
        let closest = self.search.closest(&place);
        Apart {
            from: self.number,
            place,
            to: closest.triangle as u32,
            nearest: closest.point,
            distance: closest.distance,
        }
    }

    /// Whether all corners lie within the bound of one triangle.
    fn is_near_one(&self, piece: &[Apart; 3]) -> bool {
        piece.iter().any(|own| {
            let [a, b, c] = self.to.corners(own.to as usize);
            let local = |point: Vector| {
                let way = point - a;
                ParryVector::new(way.x, way.y, way.z)
            };
            let triangle = Triangle::new(local(a), local(b), local(c));
            let far = |at: &Apart| triangle.distance_to_local_point(local(at.place), true);
            piece.iter().all(|at| far(at) <= self.bound)
        })
    }
}
