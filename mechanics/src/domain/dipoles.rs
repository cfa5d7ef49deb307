//! Solid angle of far triangles by the series of their dipoles about one point, to second order.
//!
//! A triangle of area vector n at the place o from the middle is seen from the way w to that middle under n . g(w + o),
//! g(r) = r / |r|^3. With N = sum n, S = sum o n^T and the moments sum n_i o_j o_k over the areas,
//!
//!   N . w / d^3 + (tr S - 3 w . S w / d^2) / d^3 + (15 Q(w) / d^2 - 3 c . w) / (2 d^5),   d = |w|,
//!
//! Q(w) = sum (n . w) (o . w)^2 and c = sum 2 (n . o) o + |o|^2 n. The first order alone sees less than none where sheets are
//! curved: the second is as large there, and of the other sign.
//!
//! Source: Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for soups and clouds, ACM Transactions on Graphics 37
//! (2018), section 3.

use nalgebra::Matrix3;

use super::triangle::Corners;
use crate::mesh::Vector;

/// Places of w_i w_j w_k with i <= j <= k, and how often each product is one of the twenty-seven.
const PRODUCTS: [([usize; 3], f64); 10] = [
    ([0, 0, 0], 1.0),
    ([1, 1, 1], 1.0),
    ([2, 2, 2], 1.0),
    ([0, 0, 1], 3.0),
    ([0, 0, 2], 3.0),
    ([0, 1, 1], 3.0),
    ([1, 1, 2], 3.0),
    ([0, 2, 2], 3.0),
    ([1, 2, 2], 3.0),
    ([0, 1, 2], 6.0),
];

/// What triangles are about a middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dipoles {
    /// N.
    area_vector: Vector,
    /// The symmetric part of S.
    first: Matrix3<f64>,
    /// c.
    trace: Vector,
    /// Q by its products.
    second: [f64; 10],
}

impl Dipoles {
    pub(super) fn of<'a>(triangles: impl Iterator<Item = &'a Corners>, middle: &Vector) -> Dipoles {
        let mut area_vector = Vector::zeros();
        let mut first = Matrix3::zeros();
        let mut trace = Vector::zeros();
        let mut second = [0.0; 10];
        for corners in triangles {
            let (normal, place) = (corners.area_vector(), corners.middle() - middle);
            // Means of o o^T over a triangle.
            let ends: Matrix3<f64> =
                corners.0.iter().map(|end| (end - middle) * (end - middle).transpose()).sum();
            let moments = (ends + place * place.transpose() * 9.0) / 12.0;
            area_vector += normal;
            first += (place * normal.transpose() + normal * place.transpose()) * 0.5;
            trace += moments * normal * 2.0 + normal * moments.trace();
            for (sum, ([i, j, k], times)) in second.iter_mut().zip(PRODUCTS) {
                let symmetric = normal[i] * moments[(j, k)]
                    + normal[j] * moments[(i, k)]
                    + normal[k] * moments[(i, j)];
                *sum += times * symmetric / 3.0;
            }
        }
        Dipoles { area_vector, first, trace, second }
    }

    /// The solid angle under which they are seen from a place that their middle is this way from.
    pub(super) fn solid_angle(&self, way: &Vector) -> f64 {
        let square = way.norm_squared();
        let cubic: f64 = PRODUCTS
            .iter()
            .zip(&self.second)
            .map(|(([i, j, k], _), own)| own * way[*i] * way[*j] * way[*k])
            .sum();
        let first = self.first.trace() - 3.0 * way.dot(&(self.first * way)) / square;
        let second = (7.5 * cubic / square - 1.5 * self.trace.dot(way)) / square;
        (self.area_vector.dot(way) + first + second) / (square * square.sqrt())
    }
}
