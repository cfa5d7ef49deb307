//! Primal-dual active set: passes that find the active contact constraints of fixed equations.

use crate::progress::Progress;
use crate::solver::SolverError;
use crate::solver::constrained::{ConstrainedSolution, ConstraintTarget, Equations, Point};

/// Passes after which no set is expected to repeat.
pub const MOST_PASSES: usize = 30;

/// A row that has changed this often presses until the end.
const MOST_FLIPS: usize = 3;

/// Relative residual of passes before the set is known.
const ON_THE_WAY: f64 = 1e-3;

/// Gaps and pressing forces below this part of the largest movement and force are rounding.
const ROUNDING: f64 = 1e-9;

/// Which rows press, and what is known of them from passes before.
#[derive(Clone, Debug, Default)]
pub struct ActiveSet {
    /// For each row.
    pub presses: Vec<bool>,
    flips: Vec<usize>,
}

/// A set that repeats.
pub struct SettledSet {
    pub point: Point,
    /// The rows that press, in the order of the multipliers.
    pub rows: Vec<usize>,
    pub passes: usize,
    /// Passes that changed the set.
    pub changes: usize,
    /// Rows that were kept because they had changed too often.
    pub kept: usize,
    pub iterations: usize,
    pub relative_residual: f64,
    /// False where passes ended before it did.
    pub repeats: bool,
}

/// Gaps without contact, and how well contact is to be met.
pub(in crate::model::fem) struct Task<'a> {
    /// For each row, in mm.
    pub gaps: &'a [f64],
    /// The largest movement, in mm.
    pub movement: f64,
    pub relative_residual: f64,
    /// That of the first passes, until the set repeats.
    pub first_residual: f64,
    /// After which a set need not repeat.
    pub most_passes: usize,
    /// For each row the force in mN with which it pressed when the answer without contact was found; nothing where none did.
    pub before: &'a [f64],
    /// Forces in mN that the answer without contact leaves, by unknown; nothing where it balances all.
    pub left: &'a [[f64; 1]],
    pub progress: &'a dyn Progress,
}

impl ActiveSet {
    /// The rows whose gap is closed where nothing presses.
    pub fn of_gaps(gaps: &[f64], movement: f64) -> Self {
        let presses = gaps.iter().map(|gap| *gap < -ROUNDING * movement).collect();
        ActiveSet { presses, flips: vec![0; gaps.len()] }
    }

    /// Passes until the set repeats. What presses is added to an answer whose gaps are given. The start may have a multiplier for
    /// each row; without, rows begin as they pressed before.
    pub(in crate::model::fem) fn settle(
        &mut self,
        equations: &mut Equations,
        task: &Task,
        start: Point,
    ) -> Result<SettledSet, SolverError> {
        let mut multiplier_of = match start.multipliers.is_empty() {
            true => task.before.to_vec(),
            false => start.multipliers,
        };
        multiplier_of.resize(self.presses.len(), 0.0);
        let mut settled = SettledSet {
            point: Point { x: start.x, multipliers: Vec::new() },
            rows: Vec::new(),
            passes: 0,
            changes: 0,
            kept: 0,
            iterations: 0,
            relative_residual: 0.0,
            repeats: false,
        };
        let mut taken_away = equations.forces(task.before);
        if !task.left.is_empty() {
            taken_away.resize(task.left.len(), [0.0]);
            taken_away.iter_mut().zip(task.left).for_each(|([away], [left])| *away -= left);
        }
        let mut wanted = task.first_residual.max(task.relative_residual);
        while settled.passes < task.most_passes {
            settled.passes += 1;
            let rows: Vec<usize> =
                (0..self.presses.len()).filter(|&row| self.presses[row]).collect();
            let values: Vec<f64> = rows.iter().map(|&row| -task.gaps[row]).collect();
            let multipliers = rows.iter().map(|&row| multiplier_of[row]).collect();
            let start = Point { x: std::mem::take(&mut settled.point.x), multipliers };
            let asked = ConstraintTarget {
                rows: &rows,
                values: &values,
                less: &taken_away,
                relative_residual: wanted,
            };
            let found = equations.solve(&asked, start, task.progress)?;
            multiplier_of.fill(0.0);
            rows.iter().zip(&found.point.multipliers).for_each(|(&row, m)| multiplier_of[row] = *m);
            settled.iterations += found.iterations;
            settled.relative_residual = found.relative_residual;
            let changed = self.classify(equations, task, &rows, &found);
            settled.point = found.point;
            settled.rows = rows;
            if changed > 0 {
                settled.changes += 1;
            } else if settled.relative_residual > task.relative_residual {
                let is_loose = wanted > ON_THE_WAY;
                if is_loose {
                    // What forces that were hardly known let go or pressed is not held against a row.
                    self.flips.fill(0);
                }
                wanted = task.relative_residual.max(if is_loose { ON_THE_WAY } else { 0.0 });
            } else {
                let is_kept =
                    |(flips, presses): &(&usize, &bool)| **flips >= MOST_FLIPS && **presses;
                settled.kept = self.flips.iter().zip(&self.presses).filter(is_kept).count();
                settled.repeats = true;
                return Ok(settled);
            }
        }
        Ok(settled)
    }

    /// Rows that pull are let go, and rows whose gap is below 0 press; how many these are.
    fn classify(
        &mut self,
        equations: &Equations,
        task: &Task,
        rows: &[usize],
        found: &ConstrainedSolution,
    ) -> usize {
        let largest = found.point.multipliers.iter().fold(0.0_f64, |most, m| most.max(m.abs()));
        let mut pulls = vec![false; self.presses.len()];
        for (&row, multiplier) in rows.iter().zip(&found.point.multipliers) {
            pulls[row] = *multiplier < -ROUNDING * largest;
        }
        let mut changed = 0;
        for (row, &pulls) in pulls.iter().enumerate() {
            let is_closed = || {
                task.gaps[row] + equations.value(row, &found.point.x) < -ROUNDING * task.movement
            };
            let presses = match self.presses[row] {
                true => !pulls || self.flips[row] >= MOST_FLIPS,
                false => is_closed(),
            };
            if presses != self.presses[row] {
                self.presses[row] = presses;
                self.flips[row] += 1;
                changed += 1;
            }
        }
        changed
    }
}
