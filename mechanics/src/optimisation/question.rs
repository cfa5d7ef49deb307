//! Input of inverse planning: segments and their bounds, targets on the skin, and why there may be no plan.

use crate::mesh::Vector;
use crate::response::Response;

/// Numbers that move a segment.
pub const PARAMETERS_PER_SEGMENT: usize = 6;

/// Between which numbers a segment may move; equal ends hold a parameter there.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentBounds {
    /// Translation along x, y and z in mm, then the angles about x, y and z in radians: lowest, highest.
    pub intervals: [(f64, f64); PARAMETERS_PER_SEGMENT],
    /// About which the segment turns, in mm.
    pub pivot: Vector,
}

/// A point of the skin: a node, or a point of a triangle that moves with its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPoint {
    corners: [u32; 3],
    weights: [f64; 3],
}

/// Where one point of the skin is to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    pub point: SkinPoint,
    /// In mm; `None` leaves a component free.
    pub displacement: [Option<f64>; 3],
}

/// Goals that are reported together.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    pub goals: Vec<Goal>,
    /// The standard deviation in mm of each component of each goal.
    pub sigma: f64,
}

/// Which segments may move how far, and what they are to reach.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    pub response: &'a Response,
    /// One for each segment of the response.
    pub bounds: &'a [SegmentBounds],
    pub targets: &'a [Target],
    /// The amounts of what acts inside, which stay; none of which is nothing.
    pub inner: &'a [f64],
}

/// One of the six numbers that move a segment, in the order of `SegmentBounds::intervals`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Parameter {
    /// The number of the segment in the response.
    pub segment: usize,
    pub number: usize,
}

/// The end of its interval at which a parameter stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    Lower,
    Upper,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptimisationError {
    #[error("no parameter is free to move")]
    NothingFree,
    #[error("no component of any target is stated")]
    NoTarget,
    #[error("the response or a target has a value that is not finite")]
    NotFinite,
    #[error(
        "after {iterations} iterations the next step is still {step:.2e} mm or degrees, wanted {wanted:.0e}"
    )]
    NotConverged { iterations: usize, step: f64, wanted: f64 },
}

impl SkinPoint {
    /// A skin node by its place in `Response::nodes`.
    pub fn node(place: u32) -> Self {
        SkinPoint { corners: [place; 3], weights: [1.0, 0.0, 0.0] }
    }

    /// The point of a triangle of skin nodes with these barycentric weights.
    pub fn within(corners: [u32; 3], weights: [f64; 3]) -> Self {
        SkinPoint { corners, weights }
    }

    /// One component of a field given at the skin nodes as x, y, z one after the other.
    pub(super) fn sample(&self, field: &[f32], component: usize) -> f64 {
        let at = |corner: u32| f64::from(field[3 * corner as usize + component]);
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * at(corner)).sum()
    }

    pub(super) fn displacement(&self, skin: &[Vector]) -> Vector {
        let corners = self.corners.iter().zip(self.weights);
        corners.fold(Vector::zeros(), |sum, (&corner, weight)| sum + skin[corner as usize] * weight)
    }
}
