//! Choice between a factorisation and iterations, and the factor or hierarchy, kept for further right-hand sides.

use std::sync::OnceLock;

use super::cholesky::Factor;
use super::conjugate_gradient::{solve_best_effort, solve_by};
use super::multigrid::Multigrid;
use super::ordering::{self, Ordering};
use super::report::SolveReport;
use super::system::{Solution, SolverError, System, Tolerance, Unknowns};
use crate::progress::Progress;

/// Up to this many rows a factorisation takes about as long as iterations do, or less.
const CHOLESKY_ROWS: usize = 2_500;

/// Up to this many multiplications, some ten seconds, a factorisation may stand in for iterations that stall and
/// would end without an answer. It cannot be interrupted.
const CHOLESKY_WORK: f64 = 1e11;

/// Above this many rows even the ordering of a factorisation costs more than it can save.
const ORDERING_ROWS: usize = 150_000;

/// Factor or hierarchy of one system, each computed when it is first needed.
#[derive(Default)]
pub struct Solver {
    factor: OnceLock<Factor>,
    hierarchy: OnceLock<Multigrid>,
}

/// Solves for each right-hand side of a system that is not needed again.
pub fn solve(
    system: &System,
    right_hand_sides: &[Unknowns],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    Solver::default().solve(system, right_hand_sides, tolerance, progress)
}

impl Solver {
    /// Solves for each right-hand side: by Cholesky where the system is small, by conjugate gradients
    /// otherwise, and by Cholesky once more where those stall and the factor is affordable.
    pub fn solve(
        &self,
        system: &System,
        right_hand_sides: &[Unknowns],
        tolerance: &Tolerance,
        progress: &dyn Progress,
    ) -> Result<Vec<Solution>, SolverError> {
        if right_hand_sides.iter().flatten().flatten().any(|value| !value.is_finite()) {
            return Err(SolverError::NotFinite);
        }
        if right_hand_sides.iter().flatten().flatten().all(|value| *value == 0.0) {
            let (unknowns, wanted) = (system.free_unknowns(), tolerance.relative_residual);
            let at_rest = SolveReport::at_rest(unknowns, wanted);
            let rest = |side: &Unknowns| Solution::at_rest(side.len(), &at_rest);
            return Ok(right_hand_sides.iter().map(rest).collect());
        }
        let iterations_mb = system.megabytes();
        if iterations_mb > tolerance.memory_mb {
            let (needed_mb, allowed_mb) = (iterations_mb, tolerance.memory_mb);
            return Err(SolverError::OverBudget { needed_mb, allowed_mb });
        }
        let rows = system.ordering.free;
        let factorise = |ordering: &Ordering, why: &str| {
            let factor = self.factor(system, ordering)?;
            let wanted = tolerance.relative_residual;
            let each = |side: &Unknowns| factor.solve(system, side, wanted, progress);
            let solved: Result<Vec<Solution>, SolverError> =
                right_hand_sides.iter().map(each).collect();
            solved.map(|solutions| because(solutions, why))
        };
        if rows <= CHOLESKY_ROWS {
            let ordering = ordering::minimum_degree(system);
            if ordering.factor_mb + iterations_mb <= tolerance.memory_mb {
                return factorise(&ordering, &format!("{rows} rows are few enough to factorise"));
            }
        }
        let why = format!("{rows} rows are cheaper to iterate than to factorise");
        let hierarchy = self.hierarchy(system, progress)?;
        match solve_by(system, hierarchy, right_hand_sides, tolerance, progress) {
            Err(stalled @ SolverError::NotConverged { .. }) => {
                match affordable(system, tolerance.memory_mb - iterations_mb) {
                    Some(order) => {
                        factorise(&order, &format!("conjugate gradients stalled: {stalled}"))
                    }
                    None => Err(stalled),
                }
            }
            other => other.map(|solutions| because(solutions, &why)),
        }
    }

    /// Solves until a relative residual is met or nothing more is gained, whichever comes first: the residual
    /// that was reached is reported. Where there is a factor the solution is as good as that is.
    pub fn solve_best_effort(
        &self,
        system: &System,
        right_hand_sides: &[Unknowns],
        relative_residual: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<Solution>, SolverError> {
        match self.factor.get() {
            Some(factor) => right_hand_sides
                .iter()
                .map(|side| factor.solve(system, side, relative_residual, progress))
                .collect(),
            None => {
                let hierarchy = self.hierarchy(system, progress)?;
                solve_best_effort(system, hierarchy, right_hand_sides, relative_residual, progress)
            }
        }
    }

    /// The hierarchy of the system.
    pub fn hierarchy(
        &self,
        system: &System,
        progress: &dyn Progress,
    ) -> Result<&Multigrid, SolverError> {
        if let Some(hierarchy) = self.hierarchy.get() {
            return Ok(hierarchy);
        }
        let hierarchy = Multigrid::new(system, progress)?;
        Ok(self.hierarchy.get_or_init(|| hierarchy))
    }

    /// The factor, where one was made.
    pub(super) fn made_factor(&self) -> Option<&Factor> {
        self.factor.get()
    }

    /// The factor for iterations that stalled without it; `None` where it takes too much work, or more memory than this.
    pub(super) fn affordable_factor(
        &self,
        system: &System,
        memory_mb: f64,
    ) -> Result<Option<&Factor>, SolverError> {
        affordable(system, memory_mb).map(|order| self.factor(system, &order)).transpose()
    }

    fn factor(&self, system: &System, ordering: &Ordering) -> Result<&Factor, SolverError> {
        if let Some(factor) = self.factor.get() {
            return Ok(factor);
        }
        let factor = Factor::new(system, ordering)?;
        Ok(self.factor.get_or_init(|| factor))
    }
}

/// The elimination order of a factorisation that stands in for iterations; `None` where it takes too much work, or more
/// memory than this.
fn affordable(system: &System, memory_mb: f64) -> Option<Ordering> {
    if system.ordering.free > ORDERING_ROWS {
        return None;
    }
    let ordering = ordering::minimum_degree(system);
    let is_affordable =
        ordering.factor_mb <= memory_mb && ordering.multiplications <= CHOLESKY_WORK;
    is_affordable.then_some(ordering)
}

fn because(mut solutions: Vec<Solution>, why: &str) -> Vec<Solution> {
    solutions.iter_mut().for_each(|solution| why.clone_into(&mut solution.report.why));
    solutions
}
