//! What every way of modelling takes and gives: load cases in, equilibria out, and the words of the solver.

use crate::mesh::{Vector, Warning};
use crate::solver::{Solution, SolverError};

/// One of several things that happen to the same tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// For each hold its displacement in mm along its held axes, in its frame.
    pub held: Vec<Vector>,
    /// For each node, in mN.
    pub forces: Vec<Vector>,
}

/// Nodal displacement in mm, and for each hold the force in mN that it exerts on the tissue.
pub struct Equilibrium {
    pub displacement: Vec<Vector>,
    pub reactions: Vec<Vector>,
    pub convergence: Convergence,
    /// Unknowns that are not held.
    pub unknowns: usize,
    /// What a reader must know of this way of modelling and of this answer.
    pub warnings: Vec<Warning>,
}

/// How an equilibrium was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    pub method: &'static str,
    pub preconditioner: &'static str,
    /// Why this method was chosen, with the numbers; empty where nothing chose.
    pub why: String,
    pub iterations: usize,
    /// Recomputed from the solution at the end.
    pub relative_residual: f64,
    /// The relative residual after each iteration, where the method has its own iterations to show.
    pub history: Vec<f64>,
    /// Steps of load or time.
    pub steps: u32,
}

impl Convergence {
    /// That of a linear system solved at once.
    pub(super) fn of(solution: &Solution) -> Self {
        Convergence {
            method: solution.method,
            preconditioner: solution.preconditioner,
            why: solution.why.clone(),
            iterations: solution.iterations,
            relative_residual: solution.relative_residual,
            history: solution.history.clone(),
            steps: 1,
        }
    }
}

/// Why there is no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    #[error(transparent)]
    Inverted(#[from] InvertedCell),
    #[error(transparent)]
    Solver(#[from] SolverError),
    #[error(
        "a step of {step_s:.3e} s grows without bound: explicit steps may take up to {limit_s:.3e} s"
    )]
    StepAboveLimit { step_s: f64, limit_s: f64 },
    #[error("no face of the tissue lies on bone: a warp has nothing to follow")]
    NoBone,
}

/// A cell whose Jacobian is not positive at a quadrature point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("cell {cell} is inverted or flat")]
pub struct InvertedCell {
    pub cell: usize,
}
