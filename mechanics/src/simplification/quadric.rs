//! Error quadrics: the sum of squared distances of a point from planes, weighted by area.
//!
//! Q(x) = xᵀ A x + 2 b·x + c, of a plane n·x + d = 0 with weight w: A = w n nᵀ, b = w d n, c = w d².
//! Source: Garland, Heckbert, Surface simplification using quadric error metrics, SIGGRAPH (1997), section 5.

use nalgebra::Matrix3;

use crate::mesh::Vector;

/// Directions in which planes are weaker than this share of the strongest hold a point nowhere.
const WEAK: f64 = 1e-3;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    a: Matrix3<f64>,
    b: Vector,
    c: f64,
}

impl Quadric {
    /// Of the plane through a point across a unit normal.
    pub fn of_plane(point: &Vector, normal: &Vector, weight: f64) -> Quadric {
        let offset = -normal.dot(point);
        Quadric {
            a: normal * normal.transpose() * weight,
            b: normal * (weight * offset),
            c: weight * offset * offset,
        }
    }

    pub fn plus(&self, other: &Quadric) -> Quadric {
        Quadric { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    /// Never negative.
    pub fn at(&self, point: &Vector) -> f64 {
        (point.dot(&(self.a * point)) + 2.0 * self.b.dot(point) + self.c).max(0.0)
    }

    /// Where it is least, and of all such places the nearest to `near`.
    pub fn least(&self, near: &Vector) -> Vector {
        let modes = self.a.symmetric_eigen();
        let strongest = modes.eigenvalues.amax();
        let slope = self.a * near + self.b;
        let mut way = Vector::zeros();
        for mode in 0..3 {
            let strength = modes.eigenvalues[mode];
            if strength > WEAK * strongest {
                let direction = modes.eigenvectors.column(mode);
                way -= direction * (direction.dot(&slope) / strength);
            }
        }
        near + way
    }
}
