//! Plan response: skin displacement as a linear function of how segments are moved.
//!
//! A segment moves by u(x) = (R - I) x + t, x from its centre: linear in the twelve numbers of R - I and t.
//! The tissue is linear too, so the skin is u = sum_k a_k c_k with one solved column c_k for each of
//! the twelve numbers of each segment: exact for every finite movement (Cotin, Delingette, Ayache
//! 1999, "pre-calculus"; VERIFICATION V.43).

pub mod build;
pub mod linearity;
mod superposition;

pub use build::{Columns, ResponseError, build, chosen};
pub use linearity::{Linearity, Nonlinearity};

use crate::mesh::Vector;
use crate::plan::RigidMovement;

/// Columns for each segment.
pub const COLUMNS_PER_SEGMENT: usize = 12;

/// The movement of a segment that a response knows.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseSegment {
    pub name: String,
    /// From where x is measured, in mm.
    pub centre: Vector,
}

/// Skin displacement for a unit of each number of each segment's movement.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    pub segments: Vec<ResponseSegment>,
    /// The skin nodes, ascending.
    pub nodes: Vec<u32>,
    /// [column][node][xyz] in mm; column 12 s + 4 i + j of segment s multiplies (R - I)_ij for j < 3
    /// and t_i for j = 3.
    pub columns: Vec<f32>,
}

/// The twelve numbers of a movement about a centre: rows of R - I, each followed by its t.
pub fn coefficients(movement: &RigidMovement, centre: &Vector) -> [f64; COLUMNS_PER_SEGMENT] {
    let rotation = movement.rotation();
    let translation = movement.displacement(centre);
    std::array::from_fn(|k| match (k / 4, k % 4) {
        (i, 3) => translation[i],
        (i, j) => rotation[(i, j)] - f64::from(u8::from(i == j)),
    })
}

impl Response {
    /// The displacement of each skin node in mm, for one movement of each segment.
    pub fn apply(&self, movements: &[RigidMovement]) -> Vec<Vector> {
        superposition::apply(&self.segments, movements, &self.columns, self.nodes.len())
    }
}
