//! Inverse planning: the movements of bone segments that take the skin where it is wanted.
//!
//! minimise  sum ((u(q) - d) / sigma)²  over  lower <= q <= upper
//!
//! u(q) = sum_k a_k(q) c_k is the skin of a plan response: linear in the twelve numbers a of each
//! segment's movement, which are smooth in its six parameters q, three translations and three angles
//! (R = Rz Ry Rx about a pivot). So the sum is reduced once to as many rows as there are columns
//! (`reduction`), and minimised by Levenberg and Marquardt's method with steps that keep to the
//! bounds (`minimum`, `bounded_step`). Growth and muscles that are stated stay as they are: their part of u is taken from d.
//!
//! With errors of standard deviation sigma, independent for each component of each point, the
//! covariance of the free parameters is (JᵀJ)⁻¹, J the derivative of (u - d) / sigma at the minimum
//! (`certainty`). Source: Bates, Watts, Nonlinear Regression Analysis and Its Applications, 1988, section 2.1.

mod bounded_step;
mod certainty;
mod minimum;
mod question;
mod reduction;
mod unknowns;
use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::response::Amounts;
pub use bounded_step::UNDETERMINED;
pub use certainty::{Certainty, Weight};
use minimum::minimise;
pub use question::{
    Bound, Goal, OptimisationError, PARAMETERS_PER_SEGMENT, Parameter, Question, SegmentBounds,
    SkinPoint, Target,
};
use reduction::Reduction;
use unknowns::Unknowns;

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
    let amounts = Amounts { movements: &movements, inner: question.inner };
    let skin = question.response.apply_all(&amounts);
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
