//! Parts of space that choose what counts.

use crate::mesh::Vector;

/// A sphere or a box along the axes, its border included; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    Sphere { centre: Vector, radius: f64 },
    Box { lower: Vector, upper: Vector },
}

impl Place {
    pub fn holds(&self, point: &Vector) -> bool {
        match self {
            Place::Sphere { centre, radius } => (point - centre).norm() <= *radius,
            Place::Box { lower, upper } => {
                (0..3).all(|axis| lower[axis] <= point[axis] && point[axis] <= upper[axis])
            }
        }
    }
}
