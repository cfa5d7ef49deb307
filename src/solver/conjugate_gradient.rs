//! Conjugate gradients preconditioned by one multigrid cycle.
//!
//! Hestenes, Stiefel 1952, in the preconditioned form of Saad, Iterative Methods for Sparse Linear
//! Systems, 2nd ed., algorithm 9.1, with the flexible (Polak-Ribiere) step of Golub, Ye 1999, because the
//! cycle is rounded to f32. The recursive residual decides when to look, the true residual f - K x
//! decides when to stop.

use super::multigrid::Multigrid;
use super::vector::{add_scaled, dot, norm, scale_and_add};
use super::{LinearSystem, Solution, SolverError, Tolerance, Watch, residual_of};

/// Iterations without a new smallest residual after which no more progress is expected.
const PATIENCE: usize = 2000;

/// Iterations after which even slow progress ends.
const MOST_ITERATIONS: usize = 50_000;

/// How often a true residual above the recursive one restarts the iteration.
const MOST_RESTARTS: usize = 8;

/// Solves until the true relative residual is met, or says where it stalled.
pub fn solve(
    system: &LinearSystem,
    tolerance: &Tolerance,
    watch: Watch,
    why: String,
) -> Result<Solution, SolverError> {
    let multigrid = Multigrid::new(system);
    let mut run = Run::new(system, &multigrid);
    let wanted = tolerance.relative_residual;
    for _ in 0..=MOST_RESTARTS {
        run.restart();
        if run.relative_residual() <= wanted {
            return Ok(run.solution(why));
        }
        run.iterate(wanted, watch)?;
    }
    Err(run.not_converged(wanted))
}

struct Run<'a> {
    system: &'a LinearSystem<'a>,
    multigrid: &'a Multigrid,
    scale: f64,
    x: Vec<f64>,
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    product: Vec<f64>,
    iterations: usize,
    history: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(system: &'a LinearSystem<'a>, multigrid: &'a Multigrid) -> Self {
        let zeros = || vec![0.0; system.right_hand_side.len()];
        Run {
            system,
            multigrid,
            scale: norm(system.right_hand_side),
            x: zeros(),
            r: zeros(),
            z: zeros(),
            p: zeros(),
            product: zeros(),
            iterations: 0,
            history: Vec::new(),
        }
    }

    /// Takes the residual from the solution itself.
    fn restart(&mut self) {
        residual_of(self.system, &self.x, &mut self.r);
    }

    fn relative_residual(&self) -> f64 {
        norm(&self.r) / self.scale
    }

    fn iterate(&mut self, wanted: f64, watch: Watch) -> Result<(), SolverError> {
        self.precondition();
        self.p.copy_from_slice(&self.z);
        let mut rho = dot(&self.r, &self.z);
        let (mut smallest, mut smallest_at) = (f64::INFINITY, self.iterations);
        loop {
            self.system.matrix.multiply(&self.p, &mut self.product);
            self.clear_held();
            let curvature = dot(&self.p, &self.product);
            if curvature.is_nan() || curvature <= 0.0 {
                return Err(self.not_converged(wanted));
            }
            let step = rho / curvature;
            add_scaled(&mut self.x, step, &self.p);
            add_scaled(&mut self.r, -step, &self.product);
            self.iterations += 1;
            let residual = self.relative_residual();
            self.remember(residual);
            if !watch(self.iterations, residual) {
                return Err(SolverError::Stopped);
            }
            if residual <= wanted {
                return Ok(());
            }
            if residual < smallest {
                (smallest, smallest_at) = (residual, self.iterations);
            }
            let stalled = self.iterations - smallest_at > PATIENCE;
            if !residual.is_finite() || stalled || self.iterations >= MOST_ITERATIONS {
                return Err(self.not_converged(wanted));
            }
            self.precondition();
            let next_rho = dot(&self.r, &self.z);
            // The part of the new correction along the last change of the residual, r - r_old = -step K p.
            let along = -step * dot(&self.product, &self.z);
            scale_and_add(&mut self.p, along / rho, &self.z);
            rho = next_rho;
        }
    }

    fn clear_held(&mut self) {
        let held = self.system.held;
        for (value, held) in self.product.iter_mut().zip(held) {
            if *held {
                *value = 0.0;
            }
        }
    }

    fn precondition(&mut self) {
        self.multigrid.apply(&self.r, &mut self.z);
    }

    /// Keeps every residual up to 100, then every tenth, for the report of a failure.
    fn remember(&mut self, residual: f64) {
        if self.iterations <= 100 || self.iterations.is_multiple_of(10) {
            self.history.push(residual);
        }
    }

    fn not_converged(&self, wanted: f64) -> SolverError {
        let mut residual = vec![0.0; self.x.len()];
        residual_of(self.system, &self.x, &mut residual);
        SolverError::NotConverged {
            iterations: self.iterations,
            residual: norm(&residual) / self.scale,
            wanted,
            history: self.history.clone(),
        }
    }

    fn solution(self, why: String) -> Solution {
        Solution {
            relative_residual: self.relative_residual(),
            unknowns: self.x,
            method: "conjugate_gradient",
            preconditioner: "multigrid",
            why,
            iterations: self.iterations,
        }
    }
}
