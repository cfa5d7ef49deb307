//! Displacement and pressure together, by conjugate residuals under a block triangular preconditioner.
//!
//!   K u + B^T p = f,  B u - C p = h        A = [[K, B^T], [B, -C]]
//!   preconditioner: u = V r_u, p = S^-1 (B u - r_p), with V one multigrid cycle of K and S = D / 3
//!
//! D is the lumped pressure mass (1/mu + 1/lambda) M. A block triangular preconditioner halves the
//! iterations of a block diagonal one (Murphy, Golub, Wathen 2000), and B u is shared with the product.
//! D / 3 stands for B K^-1 B^T + C: the part B K^-1 B^T is at most 3/(2 mu) M, and of the multiples tried on
//! shells it takes the fewest iterations, about the same for all nu.
//! The iteration is the generalised conjugate residual method of Eisenstat, Elman, Schultz 1983, truncated
//! to the last few directions (ORTHOMIN): every step minimises the residual that is reported.
//!
//! Residual: |(r_u, W r_p)| / |(f, W h)| over free unknowns, with r_u = f - K u - B^T p, r_p = h - B u + C p
//! and W_i = |B_i| / D_i, which turns a volume that is left over into the forces that its pressure would
//! put on the nodes around it. It does not lose its meaning as nu goes to 1/2.

use std::collections::VecDeque;

use nalgebra::Vector3;

use super::multigrid::Multigrid;
use super::sparse_rows::SparseRows;
use super::vector::{add_scaled, dot, norm};
use super::{LinearSystem, Solution, SolverError, Tolerance, Watch, nothing_to_solve};

/// Directions to which a new one is made conjugate: of 2, 4, 8 and all, four take within one iteration of
/// all on shells, and each costs as much as a quarter of a product.
const DIRECTIONS: usize = 4;

/// Directions to which a new one is made conjugate once few were seen not to do: where forces bend thin
/// tissue the residual stands still for some steps before it falls, and nothing may be forgotten meanwhile.
pub const MOST_DIRECTIONS: usize = 60;

/// A step that takes less than this part of the residual stands still: the next direction is then made from
/// the last product instead of the residual (ORTHODIR; Young, Jea 1980), which has hardly changed.
const STANDSTILL: f64 = 0.1;

/// S = D / 3.
const SCHUR: f64 = 3.0;

/// Iterations within which the residual has to halve.
const PATIENCE: usize = 500;

/// Iterations after which even steady progress ends.
const MOST_ITERATIONS: usize = 50_000;

/// How often a true residual above the recursive one restarts the iteration.
const MOST_RESTARTS: usize = 8;

/// K u + B^T p = f and B u - C p = h for the free displacements u and all pressures p.
pub struct MixedSystem<'a> {
    /// K, and f as its right-hand side.
    pub stiffness: LinearSystem<'a>,
    pub coupling: &'a Coupling,
    /// h, one for each pressure.
    pub volumes: &'a [f64],
}

/// What ties pressures to displacements and to each other.
pub struct Coupling {
    /// B: a row for each pressure, a column for each node.
    pub divergence: SparseRows<Vector3<f64>>,
    /// B^T.
    pub gradient: SparseRows<Vector3<f64>>,
    /// C.
    pub compliance: SparseRows<f64>,
    /// D.
    pub mass: Vec<f64>,
}

impl Coupling {
    /// Memory in MB.
    pub fn megabytes(&self) -> f64 {
        let vectors = self.divergence.megabytes() + self.gradient.megabytes();
        vectors + self.compliance.megabytes() + 8e-6 * self.mass.len() as f64
    }
}

/// Solves until the true residual is met, or says where it stalled. The unknowns are those of the
/// displacement, three a node, and then the pressures.
pub fn solve(
    system: &MixedSystem,
    multigrid: &Multigrid,
    tolerance: &Tolerance,
    watch: Watch,
) -> Result<Solution, SolverError> {
    let mut run = Run::new(system, multigrid);
    let wanted = tolerance.relative_residual;
    if !run.scale.is_finite() {
        return Err(SolverError::NotFinite);
    }
    if run.scale == 0.0 {
        return Ok(nothing_to_solve(run.x.len()));
    }
    for _ in 0..=MOST_RESTARTS {
        run.restart();
        if run.relative_residual() <= wanted {
            return Ok(run.solution());
        }
        run.iterate(wanted, watch)?;
    }
    run.restart();
    if run.relative_residual() <= wanted {
        return Ok(run.solution());
    }
    Err(run.not_converged(wanted))
}

/// A direction and A times it, scaled so that the latter has length one.
struct Direction {
    change: Vec<f64>,
    product: Vec<f64>,
}

struct Run<'a> {
    system: &'a MixedSystem<'a>,
    multigrid: &'a Multigrid,
    /// W.
    weights: Vec<f64>,
    scale: f64,
    x: Vec<f64>,
    /// (r_u, W r_p).
    r: Vec<f64>,
    directions: VecDeque<Direction>,
    /// How many directions are kept.
    keep: usize,
    iterations: usize,
    history: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(system: &'a MixedSystem<'a>, multigrid: &'a Multigrid) -> Self {
        let unknowns = system.stiffness.held.len() + system.volumes.len();
        let row_length = |row: usize| -> f64 {
            system.coupling.divergence.row(row).map(|(_, b)| b.norm_squared()).sum::<f64>().sqrt()
        };
        let mass = system.coupling.mass.iter().enumerate();
        let mut run = Run {
            system,
            multigrid,
            weights: mass.map(|(row, mass)| row_length(row) / mass).collect(),
            scale: 1.0,
            x: vec![0.0; unknowns],
            r: vec![0.0; unknowns],
            directions: VecDeque::new(),
            keep: DIRECTIONS,
            iterations: 0,
            history: Vec::new(),
        };
        run.restart();
        run.scale = norm(&run.r);
        run
    }

    /// Takes the residual from the solution itself.
    fn restart(&mut self) {
        self.directions.clear();
        let nodes = self.system.stiffness.held.len();
        let (u, p) = self.x.split_at(nodes);
        let mut volumes = vec![0.0; p.len()];
        self.system.coupling.divergence.contract(u, &mut volumes);
        let mut product = vec![0.0; self.r.len()];
        self.product(&volumes, &self.x, &mut product);
        let (force, volume) = self.r.split_at_mut(nodes);
        let right = self.system.stiffness.right_hand_side;
        for ((r, f), product) in force.iter_mut().zip(right).zip(&product) {
            *r = f - product;
        }
        let right = self.system.volumes.iter().zip(&self.weights);
        for ((r, (h, weight)), product) in volume.iter_mut().zip(right).zip(&product[nodes..]) {
            *r = weight * h - product;
        }
    }

    fn clear_held(&self, u: &mut [f64]) {
        for (value, held) in u.iter_mut().zip(self.system.stiffness.held) {
            if *held {
                *value = 0.0;
            }
        }
    }

    /// (K u + B^T p, W (B u - C p)) for x = (u, p), with B u given.
    fn product(&self, volumes: &[f64], x: &[f64], product: &mut [f64]) {
        let nodes = self.system.stiffness.held.len();
        let (u, p) = x.split_at(nodes);
        let (force, volume) = product.split_at_mut(nodes);
        self.system.stiffness.matrix.multiply(u, force);
        self.system.coupling.gradient.add_expanded(p, force);
        self.clear_held(force);
        self.system.coupling.compliance.multiply(p, volume);
        for ((value, given), weight) in volume.iter_mut().zip(volumes).zip(&self.weights) {
            *value = weight * (given - *value);
        }
    }

    /// A vector of residuals preconditioned, and A times that.
    fn new_direction(&self, from: &[f64]) -> Direction {
        let nodes = self.system.stiffness.held.len();
        let mut change = vec![0.0; self.x.len()];
        let mut product = vec![0.0; self.x.len()];
        let (u, p) = change.split_at_mut(nodes);
        self.multigrid.apply(&from[..nodes], u);
        self.clear_held(u);
        let mut volumes = vec![0.0; p.len()];
        self.system.coupling.divergence.contract(u, &mut volumes);
        for (i, p) in p.iter_mut().enumerate() {
            let left = from[nodes + i] / self.weights[i];
            *p = SCHUR * (volumes[i] - left) / self.system.coupling.mass[i];
        }
        self.product(&volumes, &change, &mut product);
        Direction { change, product }
    }

    fn relative_residual(&self) -> f64 {
        norm(&self.r) / self.scale
    }

    /// One step after the other until the recursive residual is met.
    fn iterate(&mut self, wanted: f64, watch: Watch) -> Result<(), SolverError> {
        let (mut mark, mut marked_at) = (self.relative_residual(), self.iterations);
        let mut stands_still = false;
        loop {
            let Some(new) = self.conjugate_direction(stands_still) else {
                return Err(self.not_converged(wanted));
            };
            let step = dot(&self.r, &new.product);
            stands_still = step.abs() < STANDSTILL * norm(&self.r);
            if stands_still {
                self.keep = MOST_DIRECTIONS;
            }
            add_scaled(&mut self.x, step, &new.change);
            add_scaled(&mut self.r, -step, &new.product);
            self.keep(new);
            self.iterations += 1;
            let residual = self.relative_residual();
            if self.iterations <= 100 || self.iterations.is_multiple_of(10) {
                self.history.push(residual);
            }
            if !watch(self.iterations, residual) {
                return Err(SolverError::Stopped);
            }
            if residual <= wanted {
                return Ok(());
            }
            if residual <= 0.5 * mark {
                (mark, marked_at) = (residual, self.iterations);
            }
            let stalled = self.iterations - marked_at > PATIENCE;
            if !residual.is_finite() || stalled || self.iterations >= MOST_ITERATIONS {
                return Err(self.not_converged(wanted));
            }
        }
    }

    /// A new direction whose product has length one and stands across those of the kept ones; `None` where
    /// nothing is left across them.
    fn conjugate_direction(&self, stands_still: bool) -> Option<Direction> {
        let mut new = match self.directions.back() {
            Some(last) if stands_still => self.new_direction(&last.product),
            _ => self.new_direction(&self.r),
        };
        for old in &self.directions {
            let along = dot(&new.product, &old.product);
            add_scaled(&mut new.product, -along, &old.product);
            add_scaled(&mut new.change, -along, &old.change);
        }
        let length = norm(&new.product);
        if !(length.is_finite() && length > 0.0) {
            return None;
        }
        new.product.iter_mut().for_each(|value| *value /= length);
        new.change.iter_mut().for_each(|value| *value /= length);
        Some(new)
    }

    /// Keeps a direction in place of the oldest one.
    fn keep(&mut self, new: Direction) {
        if self.directions.len() == self.keep {
            self.directions.pop_front();
        }
        self.directions.push_back(new);
    }

    fn not_converged(&mut self, wanted: f64) -> SolverError {
        self.restart();
        SolverError::NotConverged {
            iterations: self.iterations,
            residual: self.relative_residual(),
            wanted,
            history: std::mem::take(&mut self.history),
        }
    }

    fn solution(self) -> Solution {
        let pressures = self.system.volumes.len();
        Solution {
            relative_residual: self.relative_residual(),
            unknowns: self.x,
            method: "conjugate_residual",
            preconditioner: "multigrid and pressure mass",
            why: format!("{pressures} pressures make the system indefinite"),
            iterations: self.iterations,
        }
    }
}
