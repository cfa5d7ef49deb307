//! Inverse planning: the movements of bone segments that bring the skin to its targets, and the growth and tissue
//! constants that explain a measured skin.
//!
//! minimise  sum ((u(q) - d) / sigma)²  over  lower <= q <= upper
//!
//! u(q) = sum_k a_k(q) c_k is the skin of a plan response: linear in the twelve numbers a of each
//! segment's movement, which are smooth in its six parameters q, three translations and three angles
//! (R = Rz Ry Rx about a pivot). On request u(q) has the second order too, sum_{k <= l} a_k a_l U_kl, and its products are as
//! smooth. So the sum is reduced once to as many rows as there are columns (`reduction`), and minimised by Levenberg and
//! Marquardt's method with steps that keep to the bounds (`minimum`, `bounded_step`), from several starts where segments may turn far
//! (`starts`). Growth of a region has a column too, and its change of volume is a parameter beside them where it
//! is not stated. Constants of the tissue are not linear: `search` solves the response anew for each step of Gauss and Newton.
//!
//! With errors of standard deviation sigma, independent for each component of each point, the
//! covariance of the free parameters is (JᵀJ)⁻¹, J the derivative of (u - d) / sigma at the minimum
//! (`certainty`). Source: Bates, Watts, Nonlinear Regression Analysis and Its Applications, 1988, section 2.1.

mod bounded_step;
mod certainty;
mod constants;
mod minimum;
mod question;
mod reduction;
mod search;
mod starts;
mod unknowns;
use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::response::{Amounts, BeyondLinear};
pub use bounded_step::UNDETERMINED;
pub use certainty::{Certainty, Weight};
pub use constants::{ConstantBounds, ConstantError, ConstantKind};
use minimum::{LowestMinimum, lowest};
pub use question::{
    Bound, ConstantColumn, Goal, InnerBounds, OptimisationError, PARAMETERS_PER_SEGMENT, Parameter,
    Question, SegmentBounds, SkinPoint, Target,
};
use reduction::Reduction;
pub use search::{Search, SearchError, SearchResult, search};
use starts::starts;
use unknowns::Unknowns;

/// The plan that comes nearest to the targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// For each segment its translation in mm and its angles in radians.
    pub parameters: Vec<[f64; PARAMETERS_PER_SEGMENT]>,
    pub movements: Vec<RigidMovement>,
    /// For each entry of `Response::inner` how much of its column there is, and the change of volume where it is growth.
    pub inner: Vec<f64>,
    pub growth: Vec<f64>,
    /// The value of each of `Question::constants`.
    pub constants: Vec<f64>,
    /// The displacement of each skin node in mm.
    pub skin: Vec<Vector>,
    /// Second and third order of the plan, where the second order counts.
    pub beyond: Option<BeyondLinear>,
    pub targets: Vec<Residual>,
    /// Parameters with a bound that stops them; they are not free.
    pub at_bound: Vec<(Parameter, Bound)>,
    pub certainty: Certainty,
    /// The sum that was minimised.
    pub weighted_square_sum: f64,
    /// Components that it sums over.
    pub components: usize,
    pub iterations: usize,
    /// Starts of the search: more than one where segments may turn far.
    pub starts: usize,
    /// The sums of other minima that starts ended in, the lowest first: higher ones, and where the targets determine all parameters
    /// others as low with other movements.
    pub other_minima: Vec<f64>,
}

/// Residual of a target.
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
    check_free(question)?;
    minimum_of(question, None)
}

fn check_free(question: &Question) -> Result<(), OptimisationError> {
    match Unknowns::new(question).count() {
        0 => Err(OptimisationError::NothingFree),
        _ => Ok(()),
    }
}

/// The same, also where nothing is free; beside an optimum whose constants were held, the nearest minimum.
fn minimum_of(question: &Question, held: Option<&Optimum>) -> Result<Optimum, OptimisationError> {
    // 1. What may move, and what is asked of it.
    let unknowns = Unknowns::new(question);
    let reduction = Reduction::new(question)?;

    // 2. The minimum, and how certain it is.
    let starts = match held {
        Some(optimum) => vec![unknowns.beside(|parameter| optimum.value(parameter))],
        None => starts(&unknowns),
    };
    let LowestMinimum { minimum, others } = lowest(&unknowns, &reduction, &starts)?;
    let at_bound = unknowns.at_bound(&minimum.unknowns);
    let certainty = Certainty::new(&unknowns, &minimum, &at_bound);
    let is_unique = certainty.undetermined.is_empty();
    let others = others.iter().filter(|other| other.is_higher || is_unique);
    let mut other_minima: Vec<f64> = others.map(|other| other.square_sum).collect();
    other_minima.sort_by(f64::total_cmp);

    // 3. What is left of each target.
    let values = unknowns.values(&minimum.unknowns);
    let (movements, inner) = (unknowns.movements(&values), unknowns.inner(&values));
    let amounts = Amounts { movements: &movements, inner: &inner };
    let mut skin = question.response.apply_all(&amounts);
    for (constant, value) in question.constants.iter().zip(&values.constants) {
        constant.add(value - constant.value, &mut skin);
    }
    let second_order = question.second_order;
    let beyond =
        second_order.map(|form| form.apply(&question.response.segments, &movements, &mut skin));
    let residual = |target: &Target| Residual::new(target, &skin);
    Ok(Optimum {
        parameters: values.movements,
        movements,
        inner,
        growth: values.growth,
        constants: values.constants,
        targets: question.targets.iter().map(residual).collect(),
        skin,
        beyond,
        at_bound,
        certainty,
        weighted_square_sum: minimum.residual.norm_squared() + reduction.unreachable,
        components: reduction.components,
        iterations: minimum.iterations,
        starts: starts.len(),
        other_minima,
    })
}

impl Optimum {
    /// In mm, radians or shares; of Young's modulus its logarithm.
    pub fn value(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Movement { segment, number } => self.parameters[segment][number],
            Parameter::Growth(place) => self.growth[place],
            Parameter::Constant(place) => self.constants[place],
        }
    }
}

impl ConstantColumn {
    /// Adds what a change of the constant does.
    fn add(&self, change: f64, skin: &mut [Vector]) {
        for (u, derivative) in skin.iter_mut().zip(self.derivative.chunks_exact(3)) {
            *u += Vector::from_fn(|axis, _| change * f64::from(derivative[axis]));
        }
    }
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
