//! Stationary block iterations: the solver of the mass-tensor model.
//!
//! Block Jacobi: x <- x + omega D^-1 (f - K x), D the blocks of the diagonal. With omega = 1 it is eq. 32 of
//! Kim et al. 2012; it converges only where lambda_max(D^-1 K) < 2, which meshes of tetrahedra exceed from
//! nu = 0 on (docs/verification.md#v14). Any omega below 2 / lambda_max converges.
//! Block Gauss-Seidel: x_i <- K_ii^-1 (f_i - sum_{j<i} K_ij x_j - sum_{j>i} K_ij x_j_old) converges for every
//! positive definite K. The parts of the ordering are its colours: they couple only with the separator, which
//! is swept after them, so that any number of threads gives the bits of one sequential sweep.
//! Half a matrix is enough for one pass a sweep: with u_i = f_i - sum_{j>i} K_ij x_j kept for each row, the
//! residual after a sweep is u - u_old.
//!
//! Source: Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., 2003, sections 4.1 and 4.2.

use std::ops::Range;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::lanes::{Lanes, add_product, add_transposed, negated};
use super::scaling::{factor, times};
use super::vector::{column, dot, norm, pack_lanes, ratio};
use super::{Block, Solution, SolveReport, SolverError, System, Tolerance, Unknowns, tell};
use crate::progress::{Progress, Unobserved};
use crate::vectorised::vectorised;

/// The share of its limit that omega is set to: the power iteration sees lambda_max from below.
const DAMPING: f64 = 0.95;

/// Relative growth of lambda_max in one power iteration at which it is known well enough for `DAMPING`.
const EIGENVALUE_GROWTH: f64 = 1e-5;

const MOST_POWER_ITERATIONS: usize = 1000;

/// A residual this many times that of x = 0 has diverged: what converges never comes near.
const DIVERGED: f64 = 1e20;

/// The last iterations, over which the growth of a diverged residual is taken.
const GROWTH_OVER: usize = 10;

/// Values of all free rows.
type Rows = Vec<Lanes<f64, 3, 1>>;

/// Scheme of one iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Iteration {
    /// Rows one after the other, each with the newest values of the others.
    GaussSeidel,
    /// All rows at once, with omega just below 2 / lambda_max.
    DampedJacobi,
    /// All rows at once, with omega = 1.
    Jacobi,
}

/// Iterations and when they end: at the residual of the tolerance and, where one is asked for, at a relative
/// change |x - x_old| / |x| too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stationary {
    pub iteration: Iteration,
    pub relative_change: Option<f64>,
    pub most_iterations: usize,
}

/// Iterates from zero until the true residual meets its tolerance, or says that it diverged or where it
/// stands after the most iterations that are allowed.
pub fn solve(
    system: &System,
    right_hand_side: &Unknowns,
    stationary: &Stationary,
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Solution, SolverError> {
    if right_hand_side.as_flattened().iter().any(|value| !value.is_finite()) {
        return Err(SolverError::NotFinite);
    }
    let wanted = tolerance.relative_residual;
    if right_hand_side.as_flattened().iter().all(|value| *value == 0.0) {
        let at_rest = SolveReport::at_rest(system.free_unknowns(), wanted);
        return Ok(Solution::at_rest(right_hand_side.len(), &at_rest));
    }
    check_memory(system, tolerance.memory_mb)?;
    let inverse = inverse_diagonal(system)?;
    let factor = factor(right_hand_side.as_flattened().iter());
    let right_hand_side = pack_lanes::<1, 3>(&[times(right_hand_side, factor)]);
    let mut run = Run::new(system, &inverse, &right_hand_side);
    let mut solution = match stationary.iteration {
        Iteration::GaussSeidel => {
            let mut sweep = GaussSeidel::new(system, &inverse, &right_hand_side);
            run.iterate(stationary, tolerance, progress, |run| {
                sweep.sweep(&mut run.x, &mut run.residual)
            })?;
            run.solution("gauss_seidel", String::new(), wanted)
        }
        Iteration::Jacobi => {
            run.iterate(stationary, tolerance, progress, |run| run.jacobi(1.0))?;
            run.solution("jacobi", String::new(), wanted)
        }
        Iteration::DampedJacobi => {
            tell(progress, 0, 1.0, wanted)?;
            let lambda = power_iteration(system, &inverse, EIGENVALUE_GROWTH, progress)?;
            let omega = DAMPING * 2.0 / lambda;
            run.iterate(stationary, tolerance, progress, |run| run.jacobi(omega))?;
            let why = format!(
                "omega {omega:.3} is {DAMPING} of the limit 2 / lambda_max(D^-1 K), lambda_max {lambda:.3}; "
            );
            run.solution("damped_jacobi", why, wanted)
        }
    };
    solution.unknowns = times(&solution.unknowns, factor.recip());
    Ok(solution)
}

/// lambda_max(D^-1 K) over the free unknowns, from below, by power iteration until it grows by less than that
/// share in an iteration: the limit of omega is 2 / lambda_max, and 1 - lambda_max the factor of plain Jacobi.
pub fn largest_eigenvalue(system: &System, growth: f64) -> Result<f64, SolverError> {
    let inverse = inverse_diagonal(system)?;
    power_iteration(system, &inverse, growth, &Unobserved)
}

fn check_memory(system: &System, allowed_mb: f64) -> Result<(), SolverError> {
    // Inverse blocks, and five vectors.
    let own_mb = (system.ordering.free * (72 + 5 * 24)) as f64 / 1e6;
    let needed_mb = system.matrix.megabytes() + own_mb;
    match needed_mb <= allowed_mb {
        true => Ok(()),
        false => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
    }
}

/// D^-1 of the free rows, zero where held.
fn inverse_diagonal(system: &System) -> Result<Vec<Block>, SolverError> {
    let mut held = vec![[false; 3]; system.ordering.free];
    system.partly_constrained.iter().for_each(|partly| held[partly.row] = partly.held);
    let invert = |(row, held): (usize, &[bool; 3])| {
        let block = &system.matrix.diagonal[row];
        let open = Matrix3::from_fn(|i, j| match held[i] || held[j] {
            true => f64::from(u8::from(i == j)),
            false => block[i][j],
        });
        let factor = open.cholesky().ok_or(SolverError::Singular { node: row })?;
        let inverse = factor.inverse();
        Ok(std::array::from_fn(|i| {
            std::array::from_fn(|j| if held[i] || held[j] { 0.0 } else { inverse[(i, j)] })
        }))
    };
    held.iter().enumerate().map(invert).collect()
}

/// y = D^-1 x, row by row.
fn apply(inverse: &[Block], x: &[Lanes<f64, 3, 1>], y: &mut [Lanes<f64, 3, 1>]) {
    for ((block, x), y) in inverse.iter().zip(x).zip(y) {
        *y = [[0.0]; 3];
        add_product(y, block, x);
    }
}

/// Begins with values that are no eigenvector of anything and the same on every run.
fn power_iteration(
    system: &System,
    inverse: &[Block],
    growth: f64,
    progress: &dyn Progress,
) -> Result<f64, SolverError> {
    let value = |k: usize| [((k * 7919 + 13) % 1009) as f64 / 1009.0 - 0.5];
    let mut x: Rows =
        (0..system.ordering.free).map(|row| std::array::from_fn(|c| value(3 * row + c))).collect();
    system.zero_constrained(&mut x);
    let mut product = x.clone();
    let mut lambda = 0.0;
    for _ in 0..MOST_POWER_ITERATIONS {
        if progress.is_cancelled() {
            return Err(SolverError::Stopped);
        }
        system.multiply(&x, &mut product);
        apply(inverse, &product, &mut x);
        // |D^-1 K x| in the norm of D, in which D^-1 K is symmetric; the last x had length 1.
        let [squared] = dot(x.as_flattened(), product.as_flattened());
        let before = std::mem::replace(&mut lambda, squared.sqrt());
        x.as_flattened_mut().iter_mut().for_each(|[value]| *value /= lambda);
        if before > 0.0 && lambda - before <= growth * lambda && lambda >= before {
            break;
        }
    }
    Ok(lambda)
}

/// Iterates, residuals and their reports.
struct Run<'a> {
    system: &'a System,
    inverse: &'a [Block],
    right_hand_side: &'a [Lanes<f64, 3, 1>],
    x: Rows,
    residual: Rows,
    /// D^-1 times the residual, and K x.
    scratch: Rows,
    change: f64,
    relative_residual: f64,
    history: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(
        system: &'a System,
        inverse: &'a [Block],
        right_hand_side: &'a [Lanes<f64, 3, 1>],
    ) -> Self {
        let zeros = vec![[[0.0]; 3]; right_hand_side.len()];
        Run {
            system,
            inverse,
            right_hand_side,
            x: zeros.clone(),
            residual: right_hand_side.to_vec(),
            scratch: zeros,
            change: 0.0,
            relative_residual: 1.0,
            history: Vec::new(),
        }
    }

    /// `step` makes one iteration, leaves its residual and returns |x - x_old|.
    fn iterate(
        &mut self,
        stationary: &Stationary,
        tolerance: &Tolerance,
        progress: &dyn Progress,
        mut step: impl FnMut(&mut Self) -> f64,
    ) -> Result<(), SolverError> {
        let wanted = tolerance.relative_residual;
        let [scale] = norm(self.right_hand_side.as_flattened());
        for iteration in 1..=stationary.most_iterations {
            let change = step(self);
            self.change = ratio(change, norm(self.x.as_flattened())[0]);
            let mut residual = norm(self.residual.as_flattened())[0] / scale;
            let is_settled = stationary.relative_change.is_none_or(|most| self.change <= most);
            if residual <= wanted && is_settled {
                self.system.residual(self.right_hand_side, &self.x, &mut self.residual);
                residual = norm(self.residual.as_flattened())[0] / scale;
            }
            self.relative_residual = residual;
            self.history.push(residual);
            tell(progress, iteration, residual, wanted)?;
            if !residual.is_finite() || residual > DIVERGED {
                return Err(self.diverged());
            }
            if residual <= wanted && is_settled {
                return Ok(());
            }
        }
        let (residual, history) = (self.relative_residual, std::mem::take(&mut self.history));
        let iterations = stationary.most_iterations;
        Err(SolverError::NotConverged { iterations, residual, wanted, history })
    }

    /// x += omega D^-1 (f - K x).
    fn jacobi(&mut self, omega: f64) -> f64 {
        apply(self.inverse, &self.residual, &mut self.scratch);
        for (x, change) in self.x.as_flattened_mut().iter_mut().zip(self.scratch.as_flattened_mut())
        {
            change[0] *= omega;
            x[0] += change[0];
        }
        let [change] = norm(self.scratch.as_flattened());
        self.system.residual(self.right_hand_side, &self.x, &mut self.residual);
        change
    }

    fn diverged(&mut self) -> SolverError {
        let history = std::mem::take(&mut self.history);
        let iterations = history.len();
        let over = GROWTH_OVER.min(iterations - 1);
        let grown = history[iterations - 1] / history[iterations - 1 - over];
        let growth = grown.powf(1.0 / over.max(1) as f64);
        SolverError::Diverged { iterations, growth, residual: self.relative_residual, history }
    }

    fn solution(self, method: &'static str, why: String, wanted: f64) -> Solution {
        let change = self.change;
        Solution {
            unknowns: column(&self.x, 0),
            report: SolveReport {
                method,
                preconditioner: "block_diagonal",
                why: format!("{why}the last iteration changed u by {change:.1e} of its length"),
                unknowns: self.system.free_unknowns(),
                iterations: self.history.len(),
                relative_residual: self.relative_residual,
                wanted_residual: wanted,
                history: self.history,
                steps: 1,
                newton: None,
            },
        }
    }
}

/// What a sweep keeps for each row: f_i - sum_{j>i} K_ij x_j, and what that was before the sweep.
struct GaussSeidel<'a> {
    system: &'a System,
    inverse: &'a [Block],
    right_hand_side: &'a [Lanes<f64, 3, 1>],
    above: Rows,
    above_before: Rows,
}

impl<'a> GaussSeidel<'a> {
    /// For x = 0.
    fn new(
        system: &'a System,
        inverse: &'a [Block],
        right_hand_side: &'a [Lanes<f64, 3, 1>],
    ) -> Self {
        let above = right_hand_side.to_vec();
        GaussSeidel { system, inverse, right_hand_side, above_before: above.clone(), above }
    }

    /// One sweep from the first row to the last; leaves the residual and returns |x - x_old|.
    fn sweep(&mut self, x: &mut Rows, residual: &mut Rows) -> f64 {
        let ordering = &self.system.ordering;
        std::mem::swap(&mut self.above, &mut self.above_before);
        let (above, before) = (&mut self.above, &self.above_before);
        let rows = RowSweep {
            system: self.system,
            inverse: self.inverse,
            right_hand_side: self.right_hand_side,
            before,
        };
        let shares = ordering.split(x).into_par_iter().zip(ordering.split(above));
        let in_parts: Vec<f64> = shares
            .zip(&ordering.parts)
            .map(|((x, above), part)| rows.sweep(part.clone(), part.start, x, above))
            .collect();
        let in_separator = rows.sweep(ordering.separator(), 0, x, above);
        for ((residual, above), before) in residual.iter_mut().zip(above).zip(before) {
            *residual = std::array::from_fn(|c| [above[c][0] - before[c][0]]);
        }
        self.system.zero_constrained(residual);
        in_parts.into_iter().chain([in_separator]).sum::<f64>().sqrt()
    }
}

/// Shared data of a sweep's threads.
struct RowSweep<'a> {
    system: &'a System,
    inverse: &'a [Block],
    right_hand_side: &'a [Lanes<f64, 3, 1>],
    before: &'a [Lanes<f64, 3, 1>],
}

impl RowSweep<'_> {
    /// Sweeps a range of rows; `x` and `above` begin at row `first`. Returns the sum of squared changes.
    fn sweep(
        &self,
        range: Range<usize>,
        first: usize,
        x: &mut [Lanes<f64, 3, 1>],
        above: &mut [Lanes<f64, 3, 1>],
    ) -> f64 {
        let mut squared_change = 0.0;
        vectorised(
            #[inline(always)]
            || {
                for row in range.clone() {
                    squared_change += self.row(row, first, x, above);
                }
            },
        );
        squared_change
    }

    #[inline(always)]
    fn row(
        &self,
        row: usize,
        first: usize,
        x: &mut [Lanes<f64, 3, 1>],
        above: &mut [Lanes<f64, 3, 1>],
    ) -> f64 {
        let matrix = &self.system.matrix;
        let columns = matrix.pattern.columns(row);
        let blocks = &matrix.lower[matrix.pattern.range(row)];
        let mut sum = negated(&self.before[row]);
        for (&column, block) in columns.iter().zip(blocks) {
            add_product(&mut sum, block, &x[column as usize - first]);
        }
        let mut taken = [[0.0]; 3];
        add_product(&mut taken, &self.inverse[row], &sum);
        above[row - first] = self.right_hand_side[row];
        for (&column, block) in columns.iter().zip(blocks) {
            add_transposed(&mut above[column as usize - first], block, &taken);
        }
        let old = std::mem::replace(&mut x[row - first], negated(&taken));
        (0..3).map(|c| (x[row - first][c][0] - old[c][0]).powi(2)).sum()
    }
}
