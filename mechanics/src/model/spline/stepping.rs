//! Time integration of M d'' + D d' + K d = f, to rest (Ulusoy et al. 2010, eq. 2; docs/methods.md#volume-spline).
//!
//! D = d_M M + d_K K. What is solved for in each step is the increment of d; v = d'.
//!
//! Backward Euler, first order: (M/h^2 + D/h + K) (d1 - d0) = f - K d0 + M v0 / h, v1 = (d1 - d0) / h.
//! Newmark with beta 1/4 and gamma 1/2, second order, with its acceleration taken from the equation itself:
//! (4 M/h^2 + 2 D/h + K) (d1 - d0) = 2 (f - K d0) + 4 M v0 / h, v1 = 2 (d1 - d0) / h - v0
//! (Newmark 1959; Hughes, The Finite Element Method, 1987, section 9.1). It begins with four backward steps
//! of half the length, which have the same matrix and damp what a jump of the held values excites
//! (Rannacher, Numerische Mathematik 43 (1984), p. 309); alone it would swing on for ever.
//! Explicit (symplectic Euler), with masses lumped by rows: v1 = v0 + h M^-1 (f - K d0 - D v0),
//! d1 = d0 + h v1. Modes of angular frequency omega and damping c = d_M + d_K omega^2 stay bounded for
//! h < 4 / (c + sqrt(c^2 + 4 omega^2)), by the criterion of Jury; this decreases with omega, so that the
//! largest one sets the limit.

use super::stiffness::add_to_diagonal;
use crate::mesh::Vector;
use crate::model::problem::ModelError;
use crate::progress::{Progress, Unobserved};
use crate::solver::cholesky::Factor;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::lanes::Lanes;
use crate::solver::{SolverError, System, Unknowns, ordering, tell};

/// The relative residual of a step.
const STEP_RESIDUAL: f64 = 1e-10;

/// How time passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    BackwardEuler,
    Newmark,
    Explicit,
}

impl Scheme {
    /// As it stands in documents.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::BackwardEuler => "backward_euler",
            Scheme::Newmark => "newmark",
            Scheme::Explicit => "explicit",
        }
    }
}

/// Steps of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    pub scheme: Scheme,
    /// In ms.
    pub step: f64,
    /// When it has to be at rest, in ms.
    pub end: f64,
}

/// D = mass M + stiffness K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// In 1/ms.
    pub mass: f64,
    /// In ms.
    pub stiffness: f64,
}

/// A motion from rest at d = 0, under a constant force.
pub struct Motion<'a> {
    /// K, with nothing held.
    pub stiffness: &'a System,
    pub mass: &'a HalfMatrix<f64, 3>,
    pub damping: Damping,
    pub force: &'a Unknowns,
}

/// Displacement and velocity after some steps.
#[derive(Clone, Debug)]
pub struct State {
    pub displacement: Vec<Lanes<f64, 3, 1>>,
    /// In mm/ms.
    pub velocity: Vec<Lanes<f64, 3, 1>>,
    /// The length of each increment over that of the displacement.
    pub history: Vec<f64>,
    pub at_rest: bool,
}

/// Increments that tell how fast they shrink.
const REMEMBERED: usize = 8;

/// Iterations after which the largest frequency is known well enough.
const POWER_ITERATIONS: usize = 500;

impl Motion<'_> {
    /// Steps until `end`, or until the steps to come, as a geometric series, are shorter than
    /// `relative_tolerance` times the displacement.
    pub fn run(
        &self,
        clock: &Clock,
        relative_tolerance: f64,
        memory_mb: f64,
        progress: &dyn Progress,
    ) -> Result<State, ModelError> {
        match clock.scheme {
            Scheme::Explicit => self.explicit(clock, relative_tolerance, progress),
            Scheme::BackwardEuler | Scheme::Newmark => {
                self.implicit(clock, relative_tolerance, memory_mb, progress)
            }
        }
    }

    fn rest(&self) -> State {
        let zeros = || vec![[[0.0; 1]; 3]; self.force.len()];
        State { displacement: zeros(), velocity: zeros(), history: Vec::new(), at_rest: false }
    }

    /// f - K d.
    fn unbalanced(&self, displacement: &[Lanes<f64, 3, 1>]) -> Unknowns {
        let mut product = vec![[[0.0; 1]; 3]; self.force.len()];
        self.stiffness.multiply(displacement, &mut product);
        let rest = |(f, k): (&[f64; 3], &Lanes<f64, 3, 1>)| std::array::from_fn(|c| f[c] - k[c][0]);
        self.force.iter().zip(&product).map(rest).collect()
    }

    /// The length of a step above which some mode grows, in ms.
    pub fn explicit_limit(&self) -> f64 {
        let square = self.largest_square_frequency();
        let c = self.damping.mass + self.damping.stiffness * square;
        4.0 / (c + (c * c + 4.0 * square).sqrt())
    }

    /// The largest eigenvalue of M^-1 K with lumped M in 1/ms², by power iteration.
    fn largest_square_frequency(&self) -> f64 {
        let masses = self.lumped();
        // Neighbours of opposite sign: near the mode of the largest frequency from the start.
        let sign = |row: usize, k: usize| if (row + k).is_multiple_of(2) { 1.0 } else { -0.7 };
        let mut x: Vec<Lanes<f64, 3, 1>> =
            (0..masses.len()).map(|row| std::array::from_fn(|k| [sign(row, k)])).collect();
        let mut product = x.clone();
        let mut found = 0.0;
        for _ in 0..POWER_ITERATIONS {
            self.stiffness.multiply(&x, &mut product);
            let (mut energy, mut kinetic) = (0.0, 0.0);
            for ((x, k), m) in x.iter().zip(&product).zip(&masses) {
                for c in 0..3 {
                    energy += k[c][0] * k[c][0] / m;
                    kinetic += x[c][0] * k[c][0];
                }
            }
            let next = if kinetic > 0.0 { energy / kinetic } else { 0.0 };
            let scale = energy.sqrt().max(f64::MIN_POSITIVE);
            for ((x, k), m) in x.iter_mut().zip(&product).zip(&masses) {
                (0..3).for_each(|c| x[c][0] = k[c][0] / m / scale);
            }
            let settled = (next - found).abs() <= 1e-9 * next;
            found = next;
            if settled {
                break;
            }
        }
        found
    }

    /// Row sums of M.
    fn lumped(&self) -> Vec<f64> {
        let ones = vec![[[1.0]; 3]; self.force.len()];
        let mut product = ones.clone();
        self.mass.multiply(&self.stiffness.ordering, &ones, &mut product);
        product.iter().map(|row| row[0][0]).collect()
    }

    fn explicit(
        &self,
        clock: &Clock,
        relative_tolerance: f64,
        progress: &dyn Progress,
    ) -> Result<State, ModelError> {
        let limit = self.explicit_limit();
        if clock.step > limit {
            let (step_s, limit_s) = (clock.step / 1e3, limit / 1e3);
            return Err(ModelError::StepAboveLimit { step_s, limit_s });
        }
        let (masses, h) = (self.lumped(), clock.step);
        let mut state = self.rest();
        let mut product = state.velocity.clone();
        while state.has_next_step(clock, relative_tolerance, progress)? {
            let forces = self.unbalanced(&state.displacement);
            self.stiffness.multiply(&state.velocity, &mut product);
            let Damping { mass, stiffness } = self.damping;
            for (row, (v, f)) in state.velocity.iter_mut().zip(&forces).enumerate() {
                for c in 0..3 {
                    let damped = f[c] - stiffness * product[row][c][0];
                    v[c][0] += h * (damped / masses[row] - mass * v[c][0]);
                }
            }
            let step: Unknowns = state.velocity.iter().map(|v| v.map(|[v]| h * v)).collect();
            state.advance(&step);
        }
        Ok(state)
    }

    fn implicit(
        &self,
        clock: &Clock,
        relative_tolerance: f64,
        memory_mb: f64,
        progress: &dyn Progress,
    ) -> Result<State, ModelError> {
        let order = if clock.scheme == Scheme::Newmark { 2.0 } else { 1.0 };
        // Steps of both kinds share this length in the matrix: h for one, h / 2 for the other.
        let h = clock.step / order;
        let system = self.step_matrix(h);
        let ordering = ordering::minimum_degree(&system);
        let needed_mb = ordering.factor_mb + system.matrix.megabytes();
        if needed_mb > memory_mb {
            return Err(SolverError::OverBudget { needed_mb, allowed_mb: memory_mb }.into());
        }
        let factor = Factor::new(&system, &ordering)?;
        let mut state = self.rest();
        let mut product = state.velocity.clone();
        while state.has_next_step(clock, relative_tolerance, progress)? {
            let backward = order == 1.0 || state.history.len() < 4;
            let order = if backward { 1.0 } else { order };
            let mut right = self.unbalanced(&state.displacement);
            self.mass.multiply(&system.ordering, &state.velocity, &mut product);
            for (right, m) in right.iter_mut().zip(&product) {
                (0..3).for_each(|c| right[c] = order * (right[c] + m[c][0] / h));
            }
            let step = factor.solve(&system, &right, STEP_RESIDUAL, &Unobserved)?.unknowns;
            for (v, step) in state.velocity.iter_mut().zip(&step) {
                (0..3).for_each(|c| v[c][0] = step[c] / h - (order - 1.0) * v[c][0]);
            }
            state.advance(&step);
        }
        Ok(state)
    }

    /// M / h^2 + D / h + K.
    fn step_matrix(&self, h: f64) -> System {
        let System { ordering, matrix, positions, .. } = self.stiffness;
        let mass = 1.0 / (h * h) + self.damping.mass / h;
        let stiffness = 1.0 + self.damping.stiffness / h;
        let mut sum = matrix.clone();
        let blocks = sum.diagonal.iter_mut().chain(&mut sum.lower);
        let masses = self.mass.diagonal.iter().chain(&self.mass.lower);
        for (block, m) in blocks.zip(masses) {
            block.as_flattened_mut().iter_mut().for_each(|value| *value *= stiffness);
            add_to_diagonal(block, mass * m[0][0]);
        }
        System {
            ordering: ordering.clone(),
            matrix: sum,
            partly_constrained: Vec::new(),
            positions: positions.clone(),
        }
    }
}

impl State {
    /// Adds a step and records its relative length.
    fn advance(&mut self, step: &Unknowns) {
        let (mut moved, mut total) = (0.0, 0.0);
        for (d, step) in self.displacement.iter_mut().zip(step) {
            for c in 0..3 {
                d[c][0] += step[c];
                moved += step[c] * step[c];
                total += d[c][0] * d[c][0];
            }
        }
        self.history.push(if total > 0.0 { (moved / total).sqrt() } else { 0.0 });
    }

    /// Whether there is a step to take.
    fn has_next_step(
        &mut self,
        clock: &Clock,
        relative_tolerance: f64,
        progress: &dyn Progress,
    ) -> Result<bool, SolverError> {
        let steps = self.history.len();
        if steps == 0 {
            return Ok(true);
        }
        self.at_rest = self.remaining() <= relative_tolerance;
        if self.at_rest || self.time(clock) >= clock.end * (1.0 - 1e-9) {
            return Ok(false);
        }
        tell(progress, steps, self.history[steps - 1], relative_tolerance)?;
        Ok(true)
    }

    /// In ms: the first four steps of Newmark's scheme are half as long.
    fn time(&self, clock: &Clock) -> f64 {
        let steps = self.history.len() as f64;
        match clock.scheme {
            Scheme::Newmark => (steps - 0.5 * steps.min(4.0)) * clock.step,
            Scheme::BackwardEuler | Scheme::Explicit => steps * clock.step,
        }
    }

    /// The increments to come over the displacement, if they shrink as the last ones did.
    fn remaining(&self) -> f64 {
        let steps = self.history.len();
        if steps < 2 * REMEMBERED {
            return f64::INFINITY;
        }
        let largest = |range: &[f64]| range.iter().copied().fold(0.0, f64::max);
        let (before, late) = self.history[steps - 2 * REMEMBERED..].split_at(REMEMBERED);
        let (before, late) = (largest(before), largest(late));
        if late == 0.0 {
            return 0.0;
        }
        let ratio = (late / before).powf(1.0 / REMEMBERED as f64);
        if ratio < 1.0 { late / (1.0 - ratio) } else { f64::INFINITY }
    }

    /// By row.
    pub fn displacement(&self) -> Vec<Vector> {
        self.displacement.iter().map(|d| Vector::from(d.map(|[d]| d))).collect()
    }
}
