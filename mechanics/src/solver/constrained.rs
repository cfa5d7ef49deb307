//! Linear systems under linear equations: A x = G^T m - b with G x = h, m the multipliers of the equations.
//!
//! Conjugate residuals (Eisenstat, Elman, Schultz 1983) under a constraint preconditioner: with P the preconditioner of A and
//! Z = P^-1 G^T, a residual r is answered by z = P^-1 r - Z n, where (G Z) n = G P^-1 r keeps G z = 0 (Keller, Gould, Wathen,
//! SIAM J. Matrix Anal. 21, 2000; Gould, Hribar, Nocedal, SIAM J. Sci. Comput. 23, 2001). The equations hold to rounding in
//! every iteration, A and its hierarchy stay as they are, and the columns Z of equations are made once, one cycle for eight.

use rayon::prelude::*;

use super::independent::Independent;
use super::lanes::MOST_LANES;
use super::preconditioned::{Equation, Preconditioned};
use super::vector::{dot, norm, scale, subtract_all, update};
use super::{SolverError, tell};
use crate::progress::Progress;

/// Iterations after which none is expected to help.
const MOST_ITERATIONS: usize = 2000;

/// Directions to which a new one is made conjugate.
const KEPT: usize = 60;

/// Unknowns to which columns are added in one go.
const STRETCH: usize = 2048;

/// How often a true residual above the recursive one restarts the iteration.
const MOST_RESTARTS: usize = 8;

/// Equations with what was made of them.
pub struct Equations<'a> {
    matrix: Preconditioned<'a>,
    rows: Vec<Equation>,
    /// Z of each equation, once it was needed.
    columns: Vec<Option<Vec<f32>>>,
}

/// A solution, and the multiplier of each equation that was asked for.
#[derive(Clone, Debug, Default)]
pub struct Point {
    pub x: Vec<[f64; 1]>,
    pub multipliers: Vec<f64>,
}

/// How a solution was found.
pub struct ConstrainedSolution {
    pub point: Point,
    pub iterations: usize,
    pub relative_residual: f64,
}

/// Equations to be met and how well.
pub struct ConstraintTarget<'a> {
    /// Which equations, by their numbers.
    pub rows: &'a [usize],
    /// h of each.
    pub values: &'a [f64],
    /// b; nothing where it is 0.
    pub less: &'a [[f64; 1]],
    pub relative_residual: f64,
}

struct Direction {
    change: Vec<[f64; 1]>,
    multipliers: Vec<f64>,
    product: Vec<[f64; 1]>,
}

impl<'a> Equations<'a> {
    pub fn new(matrix: Preconditioned<'a>, rows: Vec<Equation>) -> Self {
        let columns = rows.iter().map(|_| None).collect();
        Equations { matrix, rows, columns }
    }

    /// Puts other equations in the place of these, of which some are the same as before: `same` has their numbers of before.
    pub fn replace(&mut self, rows: Vec<Equation>, same: &[Option<usize>]) {
        let mut before = std::mem::take(&mut self.columns);
        self.columns = same.iter().map(|old| old.and_then(|old| before[old].take())).collect();
        self.rows = rows;
    }

    /// G x of one equation.
    pub fn value(&self, row: usize, x: &[[f64; 1]]) -> f64 {
        self.rows[row].iter().map(|&(at, coefficient)| coefficient * x[at as usize][0]).sum()
    }

    /// G^T m of the first equations; nothing where there are no multipliers.
    pub fn forces(&self, multipliers: &[f64]) -> Vec<[f64; 1]> {
        if multipliers.is_empty() {
            return Vec::new();
        }
        let mut forces = vec![[0.0]; self.matrix.unknowns()];
        let rows: Vec<usize> = (0..multipliers.len()).collect();
        add_transposed(self, &rows, multipliers, &mut forces);
        forces
    }

    /// Meets some of the equations, from a point near by.
    pub fn solve(
        &mut self,
        wanted: &ConstraintTarget,
        start: Point,
        progress: &dyn Progress,
    ) -> Result<ConstrainedSolution, SolverError> {
        self.make_columns(wanted.rows, progress)?;
        let independent = Independent::new(&self.schur(wanted.rows));
        let mut run = Run {
            equations: self,
            wanted,
            independent,
            point: start,
            r: Vec::new(),
            scale: 0.0,
            iterations: 0,
        };
        let relative_residual = run.solve(progress)?;
        let Run { point, iterations, .. } = run;
        Ok(ConstrainedSolution { point, iterations, relative_residual })
    }

    fn make_columns(&mut self, rows: &[usize], progress: &dyn Progress) -> Result<(), SolverError> {
        let missing: Vec<usize> =
            rows.iter().copied().filter(|&row| self.columns[row].is_none()).collect();
        for chunk in missing.chunks(MOST_LANES) {
            if progress.is_cancelled() {
                return Err(SolverError::Stopped);
            }
            let equations: Vec<&Equation> = chunk.iter().map(|&row| &self.rows[row]).collect();
            for (&row, column) in chunk.iter().zip(self.matrix.columns(&equations)) {
                self.columns[row] = Some(column);
            }
        }
        Ok(())
    }

    fn column(&self, row: usize) -> &[f32] {
        self.columns[row].as_deref().unwrap_or_default()
    }

    /// G Z.
    fn schur(&self, rows: &[usize]) -> Vec<Vec<f64>> {
        let entry = |row: usize, column: &[f32]| -> f64 {
            self.rows[row].iter().map(|&(at, g)| g * f64::from(column[at as usize])).sum()
        };
        let of_row =
            |&row: &usize| rows.iter().map(|&other| entry(row, self.column(other))).collect();
        rows.iter().map(of_row).collect()
    }
}

struct Run<'a, 'b> {
    equations: &'b Equations<'a>,
    wanted: &'b ConstraintTarget<'b>,
    independent: Independent,
    point: Point,
    r: Vec<[f64; 1]>,
    /// Norm that residuals are relative to.
    scale: f64,
    iterations: usize,
}

impl Run<'_, '_> {
    fn solve(&mut self, progress: &dyn Progress) -> Result<f64, SolverError> {
        let unknowns = self.equations.matrix.unknowns();
        if self.wanted.rows.is_empty() && self.wanted.less.is_empty() {
            self.point = Point { x: vec![[0.0]; unknowns], multipliers: Vec::new() };
            return Ok(0.0);
        }
        self.point.x.resize(unknowns, [0.0]);
        self.point.multipliers.resize(self.wanted.rows.len(), 0.0);
        for dependent in self.independent.dependent() {
            self.point.multipliers[dependent] = 0.0;
        }
        let mut residual = f64::INFINITY;
        for _ in 0..=MOST_RESTARTS {
            self.satisfy_equations();
            residual = self.true_residual();
            if !residual.is_finite() {
                return Err(SolverError::NotFinite);
            }
            if residual <= self.wanted.relative_residual {
                return Ok(residual);
            }
            self.iterate(progress)?;
        }
        Err(self.not_converged(residual))
    }

    /// x += Z (G Z)^-1 (h - G x), and the multipliers with it.
    fn satisfy_equations(&mut self) {
        let rows = self.wanted.rows.iter().zip(self.wanted.values);
        let left: Vec<f64> =
            rows.map(|(&row, value)| value - self.equations.value(row, &self.point.x)).collect();
        let change = self.independent.solve(&left);
        add_columns(self.equations, self.wanted.rows, &change, 1.0, &mut self.point.x);
        self.point.multipliers.iter_mut().zip(&change).for_each(|(m, change)| *m += change);
    }

    /// G^T m, and what residuals are relative to: the larger one of its norm and that of b.
    fn forces(&self) -> (Vec<[f64; 1]>, f64) {
        let mut forces = vec![[0.0]; self.point.x.len()];
        add_transposed(self.equations, self.wanted.rows, &self.point.multipliers, &mut forces);
        let scale = norm(&forces)[0];
        match self.wanted.less.is_empty() {
            true => (forces, scale),
            false => (forces, scale.max(norm(self.wanted.less)[0])),
        }
    }

    /// Sets r = G^T m - b - A x, and returns it relative to the forces; where there are none, as after the last row that pressed
    /// has gone, to itself.
    fn true_residual(&mut self) -> f64 {
        let (mut forces, scale) = self.forces();
        forces.iter_mut().zip(self.wanted.less).for_each(|([force], [less])| *force -= less);
        let product = self.equations.matrix.product(&self.point.x);
        subtract_all(&mut forces, &[([1.0], &product)]);
        self.r = forces;
        let left = norm(&self.r)[0];
        self.scale = if scale > 0.0 { scale } else { left };
        if left == 0.0 { 0.0 } else { left / self.scale }
    }

    fn iterate(&mut self, progress: &dyn Progress) -> Result<(), SolverError> {
        let mut kept: Vec<Direction> = Vec::new();
        loop {
            let Some(new) = self.direction(&kept) else { return Ok(()) };
            let step = dot(&self.r, &new.product);
            let norms = update(&mut self.point.x, &mut self.r, &step, &new.change, &new.product);
            let multipliers = self.point.multipliers.iter_mut().zip(&new.multipliers);
            multipliers.for_each(|(m, change)| *m += step[0] * change);
            if kept.len() == KEPT {
                kept.remove(0);
            }
            kept.push(new);
            self.iterations += 1;
            let residual = norms[0] / self.scale;
            tell(progress, self.iterations, residual, self.wanted.relative_residual)?;
            if residual <= self.wanted.relative_residual {
                return Ok(());
            }
            if self.iterations >= MOST_ITERATIONS || !residual.is_finite() {
                return Err(self.not_converged(residual));
            }
        }
    }

    /// The residual answered within the equations, across the products of earlier directions.
    fn direction(&self, kept: &[Direction]) -> Option<Direction> {
        let (rows, matrix) = (self.wanted.rows, &self.equations.matrix);
        let mut change = matrix.precondition(&self.r);
        let left: Vec<f64> = rows.iter().map(|&row| self.equations.value(row, &change)).collect();
        let n = self.independent.solve(&left);
        add_columns(self.equations, rows, &n, -1.0, &mut change);
        let mut product = matrix.product(&change);
        add_transposed(self.equations, rows, &n, &mut product);
        let mut multipliers: Vec<f64> = n.iter().map(|n| -n).collect();

        let along: Vec<[f64; 1]> = kept.iter().map(|old| dot(&product, &old.product)).collect();
        let terms = |of: fn(&Direction) -> &[[f64; 1]]| -> Vec<([f64; 1], &[[f64; 1]])> {
            along.iter().copied().zip(kept.iter().map(of)).collect()
        };
        subtract_all(&mut product, &terms(|old| &old.product));
        subtract_all(&mut change, &terms(|old| &old.change));
        for (old, [along]) in kept.iter().zip(&along) {
            let pairs = multipliers.iter_mut().zip(&old.multipliers);
            pairs.for_each(|(m, old)| *m -= along * old);
        }
        let [length] = norm(&product);
        if !(length.is_finite() && length > 0.0) {
            return None;
        }
        scale(&mut product, &[1.0 / length]);
        scale(&mut change, &[1.0 / length]);
        multipliers.iter_mut().for_each(|m| *m /= length);
        Some(Direction { change, multipliers, product })
    }

    fn not_converged(&self, residual: f64) -> SolverError {
        let wanted = self.wanted.relative_residual;
        SolverError::NotConverged {
            iterations: self.iterations,
            residual,
            wanted,
            history: Vec::new(),
        }
    }
}

/// x += factor Z n, a stretch of x at a time: it stays in the first cache while columns stream past.
fn add_columns(equations: &Equations, rows: &[usize], n: &[f64], factor: f64, x: &mut [[f64; 1]]) {
    let terms = rows.iter().zip(n).filter(|(_, n)| **n != 0.0);
    let terms: Vec<(f64, &[f32])> =
        terms.map(|(&row, n)| (factor * n, equations.column(row))).collect();
    x.par_chunks_mut(STRETCH).enumerate().for_each(|(place, x)| {
        for (by, column) in &terms {
            let column = &column[place * STRETCH..];
            x.iter_mut().zip(column).for_each(|([x], z)| *x += by * f64::from(*z));
        }
    });
}

/// y += G^T n.
fn add_transposed(equations: &Equations, rows: &[usize], n: &[f64], y: &mut [[f64; 1]]) {
    for (&row, n) in rows.iter().zip(n) {
        equations.rows[row].iter().for_each(|&(at, g)| y[at as usize][0] += n * g);
    }
}
