//! Inverse planning: the movements of bone segments that take the skin where it is wanted.
//!
//! minimise  sum ((u(q) - d) / sigma)²  over  lower <= q <= upper
//!
//! u(q) = sum_k a_k(q) c_k is the skin of a plan response: linear in the twelve numbers a of each
//! segment's movement, which are smooth in its six parameters q, three translations and three angles
//! (R = Rz Ry Rx about a pivot). So the sum is reduced once to as many rows as there are columns
//! (`reduction`), and minimised by Levenberg and Marquardt's method with steps that keep to the
//! bounds (`minimum`, `bounded_step`).
//!
//! With errors of standard deviation sigma, independent for each component of each point, the
//! covariance of the free parameters is (JᵀJ)⁻¹, J the derivative of (u - d) / sigma at the minimum
//! (`certainty`). Source: Bates, Watts, Nonlinear Regression Analysis and Its Applications, 1988, section 2.1.

mod bounded_step;
mod certainty;
mod minimum;
mod reduction;
mod unknowns;

use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::response::Response;
use minimum::minimise;
use reduction::Reduction;
use unknowns::Unknowns;

pub use bounded_step::UNDETERMINED;
pub use certainty::{Certainty, Weight};

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

/// The plan that comes nearest to the targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// For each segment its translation in mm and its angles in radians.
    pub parameters: Vec<[f64; PARAMETERS_PER_SEGMENT]>,
    pub movements: Vec<RigidMovement>,
    pub targets: Vec<Residual>,
    /// Parameters with a bound that stops them; they are not free.
    pub at_bound: Vec<(Parameter, Bound)>,
    pub certainty: Certainty,
    /// The sum that was minimised.
    pub weighted_square_sum: f64,
    /// Components that it sums over.
    pub components: usize,
    pub iterations: usize,
}

/// What is left of a target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Root of the mean over its points of the squared distance in the components that are not free, in mm.
    pub rms: f64,
    /// The largest of these distances, in mm.
    pub largest: f64,
    pub points: usize,
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
    fn sample(&self, field: &[f32], component: usize) -> f64 {
        let at = |corner: u32| f64::from(field[3 * corner as usize + component]);
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * at(corner)).sum()
    }

    fn displacement(&self, skin: &[Vector]) -> Vector {
        let corners = self.corners.iter().zip(self.weights);
        corners.fold(Vector::zeros(), |sum, (&corner, weight)| sum + skin[corner as usize] * weight)
    }
}

/// Finds the plan within the bounds that comes nearest to the targets.
pub fn optimise(question: &Question) -> Result<Optimum, OptimisationError> {
    // 1. What may move, and what is asked of it.
    let unknowns = Unknowns::new(&question.response.segments, question.bounds);
    if unknowns.count() == 0 {
        return Err(OptimisationError::NothingFree);
    }
    let reduction = Reduction::new(question)?;

    // 2. The minimum, and how certain it is.
    let minimum = minimise(&unknowns, &reduction)?;
    let at_bound = unknowns.at_bound(&minimum.unknowns);
    let certainty = Certainty::new(&unknowns, &minimum, &at_bound);

    // 3. What is left of each target.
    let movements = unknowns.movements(&minimum.unknowns);
    let skin = question.response.apply(&movements);
    let residual = |target: &Target| Residual::new(target, &skin);
    Ok(Optimum {
        parameters: unknowns.parameters(&minimum.unknowns),
        movements,
        targets: question.targets.iter().map(residual).collect(),
        at_bound,
        certainty,
        weighted_square_sum: minimum.residual.norm_squared() + reduction.unreachable,
        components: reduction.components,
        iterations: minimum.iterations,
    })
}

impl Residual {
    fn new(target: &Target, skin: &[Vector]) -> Self {
        let mut residual = Residual { points: target.goals.len(), ..Residual::default() };
        let mut square_sum = 0.0;
        for goal in &target.goals {
            let reached = goal.point.displacement(skin);
            let left = Vector::from_fn(|k, _| goal.displacement[k].map_or(0.0, |d| reached[k] - d));
            square_sum += left.norm_squared();
            residual.largest = residual.largest.max(left.norm());
        }
        residual.rms = (square_sum / residual.points.max(1) as f64).sqrt();
        residual
    }
}
