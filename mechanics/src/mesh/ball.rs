//! Balls about cells.

use super::{Vector, VolumeMesh};

/// The ball about the middle of a cell that has all of it.
#[derive(Clone, Copy)]
pub struct Ball {
    pub middle: Vector,
    pub squared_radius: f64,
}

impl Ball {
    pub fn of(mesh: &VolumeMesh, cell: usize) -> Ball {
        let middle = mesh.centroid(cell);
        let squared = mesh.corners(cell).map(|x| (x - middle).norm_squared());
        Ball { middle, squared_radius: squared.fold(0.0, f64::max) }
    }

    /// With room for rounding.
    pub fn radius(&self) -> f64 {
        self.squared_radius.sqrt() * (1.0 + 1e-9)
    }
}
