//! Conjugate residuals for displacement and pressure together, one iteration after the other; the equations, the preconditioner
//! and the residual are those of `mixed`.

use super::inverse_stiffness::{InverseStiffness, ReadyInverse};
use super::lanes::Lanes;
use super::mixed_system::{MixedRightHandSide, MixedSolution, MixedSystem};
use super::vector::{column, dot, largest, norm, pack_lanes, ratio, scale, subtract_all, update};
use super::{Solution, SolveReport, SolverError, Unknowns, tell};
use crate::progress::Progress;
use std::collections::VecDeque;

/// Directions to which a new one is made conjugate: of 2, 4, 8 and all, four take within one iteration of
/// all on shells, and each costs as much as a quarter of a product.
const DIRECTIONS: usize = 4;

/// Directions to which a new one is made conjugate once few were seen not to do: where forces bend thin
/// tissue the residual stands still for some steps before it falls, and nothing may be forgotten meanwhile.
pub const MOST_DIRECTIONS: usize = 60;

/// A step that reduces the residual by less than this part stagnates: the next direction is then made from the last
/// product instead of the residual (ORTHODIR; Young, Jea 1980), which has hardly changed.
const STANDSTILL: f64 = 0.1;

/// S = D / 3.
const SCHUR: f64 = 3.0;

/// Iterations within which the residual has to halve.
const PATIENCE: usize = 500;

/// Iterations after which even steady progress ends.
const MOST_ITERATIONS: usize = 50_000;

/// How often a true residual above the recursive one restarts the iteration.
const MOST_RESTARTS: usize = 8;

/// A direction and A times it, scaled so that the latter has length one.
struct Direction<const N: usize> {
    change: Vec<[f64; N]>,
    product: Vec<[f64; N]>,
}

/// Vectors have three unknowns for each free row, and then the pressures.
pub(super) struct Run<'a, const N: usize> {
    system: &'a MixedSystem<'a>,
    inverse: InverseStiffness<'a, N>,
    columns: usize,
    /// W.
    weights: Vec<f64>,
    /// (f, W h).
    right_hand_side: Vec<[f64; N]>,
    scale: [f64; N],
    pub x: Vec<[f64; N]>,
    /// (r_u, W r_p).
    r: Vec<[f64; N]>,
    directions: VecDeque<Direction<N>>,
    /// How many directions are kept.
    pub keep: usize,
    pub iterations: usize,
    pub most_iterations: usize,
    own_iterations: [usize; N],
    history: Vec<f64>,
}

impl<'a, const N: usize> Run<'a, N> {
    pub fn new(
        system: &'a MixedSystem<'a>,
        made: ReadyInverse<'a>,
        columns: &[MixedRightHandSide],
    ) -> Self {
        let coupling = system.coupling;
        let weights = coupling.weights();
        let forces: Vec<Unknowns> = columns.iter().map(|right| right.forces.clone()).collect();
        let volumes: Vec<Vec<[f64; 1]>> =
            columns.iter().map(|right| right.volumes.clone()).collect();
        let mut right_hand_side: Vec<[f64; N]> =
            pack_lanes::<N, 3>(&forces).into_iter().flatten().collect();
        for ([values], weight) in pack_lanes::<N, 1>(&volumes).iter().zip(&weights) {
            right_hand_side.push(values.map(|value| weight * value));
        }
        let unknowns = right_hand_side.len();
        Run {
            system,
            inverse: InverseStiffness::new(made),
            columns: columns.len(),
            weights,
            scale: norm(&right_hand_side),
            r: right_hand_side.clone(),
            right_hand_side,
            x: vec![[0.0; N]; unknowns],
            directions: VecDeque::new(),
            keep: DIRECTIONS,
            iterations: 0,
            most_iterations: MOST_ITERATIONS,
            own_iterations: [0; N],
            history: Vec::new(),
        }
    }

    pub fn solve(
        mut self,
        wanted: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<MixedSolution>, SolverError> {
        if self.scale.iter().any(|scale| !scale.is_finite()) {
            return Err(SolverError::NotFinite);
        }
        for restart in 0..=MOST_RESTARTS {
            if restart > 0 {
                self.restart();
            }
            if largest(&self.relative_residuals()) <= wanted {
                return Ok(self.solutions(wanted));
            }
            self.iterate(wanted, progress)?;
        }
        Err(self.not_converged(wanted))
    }

    /// One run of the recursive residual, whatever it reaches.
    pub fn solve_best_effort(
        mut self,
        wanted: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<MixedSolution>, SolverError> {
        if largest(&self.relative_residuals()) > wanted {
            match self.iterate(wanted, progress) {
                Ok(()) | Err(SolverError::NotConverged { .. }) => (),
                Err(other) => return Err(other),
            }
        }
        match self.x.iter().chain(&self.r).flatten().all(|value| value.is_finite()) {
            true => Ok(self.solutions(wanted)),
            false => Err(SolverError::NotFinite),
        }
    }

    /// Unknowns that are displacements.
    pub fn displacements(&self) -> usize {
        3 * self.system.stiffness.ordering.free
    }

    /// Takes the residual from the solution itself.
    fn restart(&mut self) {
        self.directions.clear();
        let (u, p) = self.x.split_at(self.displacements());
        let mut volumes = vec![[0.0; N]; p.len()];
        self.system.coupling.divergence.contract(u.as_chunks().0, &mut volumes);
        let mut product = vec![[0.0; N]; self.r.len()];
        self.product(&volumes, &self.x, &mut product);
        self.r.copy_from_slice(&self.right_hand_side);
        subtract_all(&mut self.r, &[([1.0; N], &product)]);
    }

    /// (K u + B^T p, W (B u - C p)) for x = (u, p), with B u given.
    fn product(&self, volumes: &[[f64; N]], x: &[[f64; N]], product: &mut [[f64; N]]) {
        let (u, p) = x.split_at(self.displacements());
        let (force, volume) = product.split_at_mut(self.displacements());
        let force: &mut [Lanes<f64, 3, N>] = force.as_chunks_mut().0;
        self.system.stiffness.multiply(u.as_chunks().0, force);
        self.system.coupling.gradient.add_expanded(p, force);
        self.system.stiffness.zero_constrained(force);
        self.system.coupling.compliance.multiply(p, volume);
        for ((value, given), weight) in volume.iter_mut().zip(volumes).zip(&self.weights) {
            for n in 0..N {
                value[n] = weight * (given[n] - value[n]);
            }
        }
    }

    /// Residuals preconditioned, and A times that. Where the residual of a right-hand side stands still its
    /// last product takes its place.
    fn new_direction(&mut self, stands_still: &[bool; N]) -> Direction<N> {
        let displacements = self.displacements();
        let mut from = self.r.clone();
        if let Some(last) = self.directions.back() {
            for n in (0..N).filter(|&n| stands_still[n]) {
                from.iter_mut().zip(&last.product).for_each(|(from, last)| from[n] = last[n]);
            }
        }
        let (forces, left_volumes) = from.split_at(displacements);
        let mut change = vec![[0.0; N]; from.len()];
        let (u, p) = change.split_at_mut(displacements);
        self.inverse.apply(forces.as_chunks().0, u.as_chunks_mut().0);
        let mut volumes = vec![[0.0; N]; p.len()];
        self.system.coupling.divergence.contract(u.as_chunks().0, &mut volumes);
        for (i, p) in p.iter_mut().enumerate() {
            let factor = SCHUR / self.system.coupling.mass[i];
            for n in 0..N {
                p[n] = factor * (volumes[i][n] - left_volumes[i][n] / self.weights[i]);
            }
        }
        let mut product = vec![[0.0; N]; from.len()];
        self.product(&volumes, &change, &mut product);
        Direction { change, product }
    }

    fn relative_residuals(&self) -> [f64; N] {
        self.relative(&norm(&self.r))
    }

    fn relative(&self, norms: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|n| ratio(norms[n], self.scale[n]))
    }

    /// One step after the other until the recursive residual is met.
    pub fn iterate(&mut self, wanted: f64, progress: &dyn Progress) -> Result<(), SolverError> {
        let mut residuals = self.relative_residuals();
        let (mut mark, mut marked_at) = (largest(&residuals), self.iterations);
        let mut stands_still = [false; N];
        loop {
            let is_open: [bool; N] = std::array::from_fn(|n| residuals[n] > wanted);
            let Some(new) = self.conjugate_direction(&stands_still, &is_open) else {
                return Err(self.not_converged(wanted));
            };
            let along = dot(&self.r, &new.product);
            let step = std::array::from_fn(|n| if is_open[n] { along[n] } else { 0.0 });
            for n in (0..N).filter(|&n| is_open[n]) {
                self.own_iterations[n] += 1;
                stands_still[n] = along[n].abs() < STANDSTILL * residuals[n] * self.scale[n];
                if stands_still[n] {
                    self.keep = MOST_DIRECTIONS / N;
                }
            }
            let norms = update(&mut self.x, &mut self.r, &step, &new.change, &new.product);
            self.keep(new);
            self.iterations += 1;
            residuals = self.relative(&norms);
            let residual = largest(&residuals);
            if self.iterations <= 100 || self.iterations.is_multiple_of(10) {
                self.history.push(residual);
            }
            tell(progress, self.iterations, residual, wanted)?;
            if residual <= wanted {
                return Ok(());
            }
            if residual <= 0.5 * mark {
                (mark, marked_at) = (residual, self.iterations);
            }
            let stalled = self.iterations - marked_at > PATIENCE;
            if !residual.is_finite() || stalled || self.iterations >= self.most_iterations {
                return Err(self.not_converged(wanted));
            }
        }
    }

    /// A new direction whose product has length one and stands across those of the kept ones; `None` where
    /// nothing is left across them for a right-hand side that is open.
    fn conjugate_direction(
        &mut self,
        stands_still: &[bool; N],
        is_open: &[bool; N],
    ) -> Option<Direction<N>> {
        let mut new = self.new_direction(stands_still);
        let along: Vec<[f64; N]> =
            self.directions.iter().map(|old| dot(&new.product, &old.product)).collect();
        let terms = |of: fn(&Direction<N>) -> &[[f64; N]]| -> Vec<([f64; N], &[[f64; N]])> {
            along.iter().copied().zip(self.directions.iter().map(of)).collect()
        };
        subtract_all(&mut new.product, &terms(|old| &old.product));
        subtract_all(&mut new.change, &terms(|old| &old.change));
        let length = norm(&new.product);
        if (0..N).any(|n| is_open[n] && !(length[n].is_finite() && length[n] > 0.0)) {
            return None;
        }
        let inverse = length.map(|length| ratio(1.0, length));
        scale(&mut new.product, &inverse);
        scale(&mut new.change, &inverse);
        Some(new)
    }

    /// Keeps a direction in place of the oldest one.
    fn keep(&mut self, new: Direction<N>) {
        if self.directions.len() == self.keep {
            self.directions.pop_front();
        }
        self.directions.push_back(new);
    }

    fn not_converged(&mut self, wanted: f64) -> SolverError {
        self.restart();
        SolverError::NotConverged {
            iterations: self.iterations,
            residual: largest(&self.relative_residuals()),
            wanted,
            history: std::mem::take(&mut self.history),
        }
    }

    fn solutions(self, wanted: f64) -> Vec<MixedSolution> {
        let residuals = self.relative_residuals();
        let (u, p) = self.x.split_at(self.displacements());
        let (u, p): (&[Lanes<f64, 3, N>], &[[[f64; N]; 1]]) = (u.as_chunks().0, p.as_chunks().0);
        let solution = |n: usize| Solution {
            unknowns: column(u, n),
            report: SolveReport {
                method: if self.scale[n] == 0.0 { "none" } else { "conjugate_residual" },
                preconditioner: self.inverse.preconditioner(),
                why: format!("{} pressures make the system indefinite", p.len()),
                unknowns: self.system.free_unknowns(),
                iterations: self.own_iterations[n],
                relative_residual: residuals[n],
                wanted_residual: wanted,
                history: Vec::new(),
                steps: 1,
                newton: None,
            },
        };
        (0..self.columns)
            .map(|n| MixedSolution { solution: solution(n), pressures: column(p, n) })
            .collect()
    }
}
