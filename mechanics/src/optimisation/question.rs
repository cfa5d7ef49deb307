//! Input of inverse planning: segments, growth and constants with their bounds, targets on the skin, and its errors.

use crate::mesh::Vector;
use crate::response::{QuadraticForm, Response};

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
    /// The second order of the response, where it is to count.
    pub second_order: Option<&'a QuadraticForm>,
    /// One for each segment of the response.
    pub bounds: &'a [SegmentBounds],
    pub targets: &'a [Target],
    /// How much there may be of each of [`Response::inner`]; none of which is nothing.
    pub inner: &'a [InnerBounds],
    /// Constants of the tissue that may be other than those of the response.
    pub constants: &'a [ConstantColumn],
}

/// How much there may be of something that acts inside the tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InnerBounds {
    /// This much of its column, whatever the plan.
    Held(f64),
    /// A change of volume as a share of it: lowest, highest. That of a region stands over that of all tissue (`*`).
    Growth(f64, f64),
}

/// Derivative of the skin by a tissue constant, near the value that the response was solved with.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantColumn {
    /// The derivative of the displacement of each skin node, as [node][xyz] in mm.
    pub derivative: Vec<f32>,
    /// The value of the response.
    pub value: f64,
    /// Lowest and highest, with the value between them.
    pub interval: (f64, f64),
}

/// One of the numbers that are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parameter {
    /// One of the six that move a segment of the response, in the order of `SegmentBounds::intervals`.
    Movement { segment: usize, number: usize },
    /// The change of volume of what this entry of [`Response::inner`] is the growth of.
    Growth(usize),
    /// The value of this entry of `Question::constants`.
    Constant(usize),
}

/// The end of its interval at which a parameter stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    Lower,
    Upper,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptimisationError {
    #[error("no parameter is free")]
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
    pub(super) fn sample<T: Copy + Into<f64>>(&self, field: &[T], component: usize) -> f64 {
        let at = |corner: u32| -> f64 { field[3 * corner as usize + component].into() };
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * at(corner)).sum()
    }

    pub(super) fn displacement(&self, skin: &[Vector]) -> Vector {
        let corners = self.corners.iter().zip(self.weights);
        corners.fold(Vector::zeros(), |sum, (&corner, weight)| sum + skin[corner as usize] * weight)
    }
}
