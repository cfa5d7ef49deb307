//! Attraction of template points to patient points, along a normal and across it.

use nalgebra::Matrix3;

use crate::mesh::Vector;

/// Least squares of n·(x - y) with weight `along`, and of x - y with weight `across`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pull {
    /// The point before it is moved, in mm.
    pub at: Vector,
    /// Where it is to go, in mm.
    pub to: Vector,
    /// Unit normal of the patient's surface; zero where only `across` counts.
    pub normal: Vector,
    pub along: f64,
    pub across: f64,
}

impl Pull {
    /// Towards a point, in every direction alike.
    pub fn to_point(at: Vector, to: Vector, weight: f64) -> Pull {
        Pull { at, to, normal: Vector::zeros(), along: 0.0, across: weight }
    }

    /// The matrix S of (x - y)ᵀ S (x - y).
    pub fn stiffness(&self) -> Matrix3<f64> {
        self.normal * self.normal.transpose() * self.along + Matrix3::identity() * self.across
    }

    pub fn weight(&self) -> f64 {
        self.along + self.across
    }
}
