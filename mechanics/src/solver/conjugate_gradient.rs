//! Conjugate gradients preconditioned by one multigrid cycle, for one or several right-hand sides at once.
//!
//! Hestenes, Stiefel 1952, in the preconditioned form of Saad, Iterative Methods for Sparse Linear
//! Systems, 2nd ed., algorithm 9.1, with the flexible (Polak-Ribiere) step of Golub, Ye 1999, because the
//! cycle is rounded to f32. The recursive residual decides when to look, the true residual f - K x
//! decides when to stop. Several right-hand sides share each pass over matrix and hierarchy; each has
//! its own steps, and stands still once it has converged.

use super::lanes::{Lanes, MOST_LANES};
use super::multigrid::{Multigrid, Workspace};
use super::scaling::scaled;
use super::vector::{axpby, column, dot, largest, norm, pack_lanes, ratio, update};
use super::{Solution, SolveReport, SolverError, System, Tolerance, Unknowns, tell};
use crate::progress::Progress;

/// Iterations without a new smallest residual after which no more progress is expected.
const PATIENCE: usize = 2000;

/// Iterations after which even slow progress ends.
const MOST_ITERATIONS: usize = 50_000;

/// How often a true residual above the recursive one restarts the iteration.
const MOST_RESTARTS: usize = 8;

/// Solves until every true relative residual is met, or says where it stalled.
pub fn solve(
    system: &System,
    right_hand_sides: &[Unknowns],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    solve_by(system, &Multigrid::new(system, progress)?, right_hand_sides, tolerance, progress)
}

/// The same with the hierarchy of the system.
pub fn solve_by(
    system: &System,
    multigrid: &Multigrid,
    right_hand_sides: &[Unknowns],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    let wanted = tolerance.relative_residual;
    scaled(right_hand_sides, |right_hand_sides| {
        in_lanes(right_hand_sides, |columns| match columns.len() {
            1 => Run::<1>::new(system, multigrid, columns).solve(wanted, progress),
            2..=4 => Run::<4>::new(system, multigrid, columns).solve(wanted, progress),
            _ => Run::<MOST_LANES>::new(system, multigrid, columns).solve(wanted, progress),
        })
    })
}

/// Solves until every relative residual is met or nothing more is gained, and keeps what was found until then.
pub fn solve_best_effort(
    system: &System,
    multigrid: &Multigrid,
    right_hand_sides: &[Unknowns],
    wanted: f64,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    scaled(right_hand_sides, |right_hand_sides| {
        in_lanes(right_hand_sides, |columns| match columns.len() {
            1 => Run::<1>::new(system, multigrid, columns).solve_best_effort(wanted, progress),
            2..=4 => Run::<4>::new(system, multigrid, columns).solve_best_effort(wanted, progress),
            _ => Run::<MOST_LANES>::new(system, multigrid, columns)
                .solve_best_effort(wanted, progress),
        })
    })
}

/// As many right-hand sides at once as share a pass.
fn in_lanes(
    right_hand_sides: &[Unknowns],
    mut solve: impl FnMut(&[Unknowns]) -> Result<Vec<Solution>, SolverError>,
) -> Result<Vec<Solution>, SolverError> {
    let mut solutions = Vec::with_capacity(right_hand_sides.len());
    for columns in right_hand_sides.chunks(MOST_LANES) {
        solutions.extend(solve(columns)?);
    }
    Ok(solutions)
}

/// A direction along which the quadratic form x.K x / 2 - f.x falls, whether K is positive definite or not.
pub struct Direction {
    /// For each free row.
    pub unknowns: Unknowns,
    pub iterations: usize,
    /// Whether K was positive definite along everything that was tried.
    pub is_convex: bool,
}

/// At which residual, or after how many iterations, a direction is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoppingCriterion {
    pub relative_residual: f64,
    pub most_iterations: usize,
}

/// Iterates until the relative residual, a direction without positive curvature or the bound of iterations is met, and
/// keeps what was found until then (Steihaug 1983). The hierarchy may be that of a matrix near by.
pub fn direction(
    system: &System,
    multigrid: &Multigrid,
    right_hand_side: &Unknowns,
    criterion: StoppingCriterion,
    progress: &dyn Progress,
) -> Result<Direction, SolverError> {
    let StoppingCriterion { relative_residual, most_iterations } = criterion;
    let mut run = Run::<1>::new(system, multigrid, std::slice::from_ref(right_hand_side));
    run.most_iterations = most_iterations;
    run.r.copy_from_slice(&run.right_hand_side);
    let is_convex = match run.iterate(relative_residual, progress) {
        Ok(()) => true,
        Err(SolverError::NotConverged { .. }) => run.iterations >= most_iterations,
        Err(other) => return Err(other),
    };
    if run.iterations == 0 && !is_convex {
        run.x.copy_from_slice(&run.p);
    }
    let unknowns = column(&run.x, 0);
    if unknowns.iter().flatten().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    Ok(Direction { unknowns, iterations: run.iterations, is_convex })
}

struct Run<'a, const N: usize> {
    system: &'a System,
    multigrid: &'a Multigrid,
    columns: usize,
    workspace: Workspace<N>,
    right_hand_side: Vec<Lanes<f64, 3, N>>,
    /// |f|
    scale: [f64; N],
    x: Vec<Lanes<f64, 3, N>>,
    r: Vec<Lanes<f64, 3, N>>,
    p: Vec<Lanes<f64, 3, N>>,
    product: Vec<Lanes<f64, 3, N>>,
    iterations: usize,
    most_iterations: usize,
    /// Iterations of each right-hand side.
    own_iterations: [usize; N],
    /// The largest relative residual.
    history: Vec<f64>,
}

impl<'a, const N: usize> Run<'a, N> {
    fn new(system: &'a System, multigrid: &'a Multigrid, columns: &[Unknowns]) -> Self {
        let right_hand_side = pack_lanes::<N, 3>(columns);
        let zeros = || vec![[[0.0; N]; 3]; right_hand_side.len()];
        Run {
            system,
            multigrid,
            columns: columns.len(),
            workspace: multigrid.workspace(),
            scale: norm(right_hand_side.as_flattened()),
            x: zeros(),
            r: zeros(),
            p: zeros(),
            product: zeros(),
            right_hand_side,
            iterations: 0,
            most_iterations: MOST_ITERATIONS,
            own_iterations: [0; N],
            history: Vec::new(),
        }
    }

    fn solve(mut self, wanted: f64, progress: &dyn Progress) -> Result<Vec<Solution>, SolverError> {
        for restart in 0..=MOST_RESTARTS {
            match restart {
                0 => self.r.copy_from_slice(&self.right_hand_side),
                _ => self.system.residual(&self.right_hand_side, &self.x, &mut self.r),
            }
            let residuals = self.relative_residuals();
            if largest(&residuals) <= wanted {
                return Ok(self.solutions(&residuals, wanted));
            }
            self.iterate(wanted, progress)?;
        }
        Err(self.not_converged(wanted))
    }

    /// One run of the recursive residual, whatever it reaches.
    fn solve_best_effort(
        mut self,
        wanted: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<Solution>, SolverError> {
        self.r.copy_from_slice(&self.right_hand_side);
        if largest(&self.relative_residuals()) > wanted {
            match self.iterate(wanted, progress) {
                Ok(()) | Err(SolverError::NotConverged { .. }) => (),
                Err(other) => return Err(other),
            }
        }
        let residuals = self.relative_residuals();
        let is_finite = |values: &Lanes<f64, 3, N>| values.iter().flatten().all(|v| v.is_finite());
        match self.x.iter().all(is_finite) && residuals.iter().all(|r| r.is_finite()) {
            true => Ok(self.solutions(&residuals, wanted)),
            false => Err(SolverError::NotFinite),
        }
    }

    fn relative_residuals(&self) -> [f64; N] {
        self.relative(&norm(self.r.as_flattened()))
    }

    fn relative(&self, norms: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|n| ratio(norms[n], self.scale[n]))
    }

    fn iterate(&mut self, wanted: f64, progress: &dyn Progress) -> Result<(), SolverError> {
        let correction = self.multigrid.apply(&self.r, &mut self.workspace);
        let z = correction.values.as_flattened();
        axpby(self.p.as_flattened_mut(), &[0.0; N], z, &correction.scale);
        let mut rho = dot(self.r.as_flattened(), self.p.as_flattened());
        let mut residuals = self.relative_residuals();
        let (mut smallest, mut smallest_at) = (f64::INFINITY, self.iterations);
        loop {
            self.system.multiply(&self.p, &mut self.product);
            let curvature = dot(self.p.as_flattened(), self.product.as_flattened());
            let is_open: [bool; N] = std::array::from_fn(|n| residuals[n] > wanted);
            if (0..N).any(|n| is_open[n] && !(curvature[n] > 0.0 && rho[n].is_finite())) {
                return Err(self.not_converged(wanted));
            }
            let step: [f64; N] =
                std::array::from_fn(|n| if is_open[n] { rho[n] / curvature[n] } else { 0.0 });
            let norms = self.update(&step);
            self.iterations += 1;
            (0..N).filter(|&n| is_open[n]).for_each(|n| self.own_iterations[n] += 1);
            residuals = self.relative(&norms);
            let residual = largest(&residuals);
            self.remember(residual);
            tell(progress, self.iterations, residual, wanted)?;
            if residual <= wanted {
                return Ok(());
            }
            if residual < smallest {
                (smallest, smallest_at) = (residual, self.iterations);
            }
            let stalled = self.iterations - smallest_at > PATIENCE;
            if !residual.is_finite() || stalled || self.iterations >= self.most_iterations {
                return Err(self.not_converged(wanted));
            }
            let correction = self.multigrid.apply(&self.r, &mut self.workspace);
            let z = correction.values.as_flattened();
            let along_residual = dot(self.r.as_flattened(), z);
            let along_product = dot(self.product.as_flattened(), z);
            // The part of the new correction along the last change of the residual, r - r_old = -step K p.
            let scale = correction.scale;
            let factor: [f64; N] =
                std::array::from_fn(|n| ratio(-step[n] * along_product[n] * scale[n], rho[n]));
            rho = std::array::from_fn(|n| along_residual[n] * scale[n]);
            axpby(self.p.as_flattened_mut(), &factor, z, &scale);
        }
    }

    /// Takes a step; returns the norm of what is left.
    fn update(&mut self, step: &[f64; N]) -> [f64; N] {
        let (x, r) = (self.x.as_flattened_mut(), self.r.as_flattened_mut());
        update(x, r, step, self.p.as_flattened(), self.product.as_flattened())
    }

    /// Keeps every residual up to 100, then every tenth, for the report of a failure.
    fn remember(&mut self, residual: f64) {
        if self.iterations <= 100 || self.iterations.is_multiple_of(10) {
            self.history.push(residual);
        }
    }

    fn not_converged(&mut self, wanted: f64) -> SolverError {
        self.system.residual(&self.right_hand_side, &self.x, &mut self.r);
        SolverError::NotConverged {
            iterations: self.iterations,
            residual: largest(&self.relative_residuals()),
            wanted,
            history: self.history.clone(),
        }
    }

    fn solutions(self, residuals: &[f64; N], wanted: f64) -> Vec<Solution> {
        (0..self.columns)
            .map(|n| Solution {
                unknowns: column(&self.x, n),
                report: SolveReport {
                    method: "conjugate_gradient",
                    preconditioner: "multigrid",
                    why: String::new(),
                    unknowns: self.system.free_unknowns(),
                    iterations: self.own_iterations[n],
                    relative_residual: residuals[n],
                    wanted_residual: wanted,
                    history: Vec::new(),
                    steps: 1,
                    newton: None,
                },
            })
            .collect()
    }
}
