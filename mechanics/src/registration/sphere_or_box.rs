//! Spheres and boxes that select points.

use crate::mesh::Vector;

/// A sphere or a box along the axes, its border included; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SphereOrBox {
    Sphere { centre: Vector, radius: f64 },
    Box { lower: Vector, upper: Vector },
}

impl SphereOrBox {
    pub fn holds(&self, point: &Vector) -> bool {
        match self {
            SphereOrBox::Sphere { centre, radius } => (point - centre).norm() <= *radius,
            SphereOrBox::Box { lower, upper } => {
                (0..3).all(|axis| lower[axis] <= point[axis] && point[axis] <= upper[axis])
            }
        }
    }
}
