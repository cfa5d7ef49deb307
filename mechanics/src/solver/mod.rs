//! Symmetric positive definite systems of 3x3 blocks: matrices, residuals, tolerances, and the choice
//! between a factorisation and iterations.

mod choice;
pub mod cholesky;
pub mod conjugate_gradient;
pub mod constrained;
pub mod element_connectivity;
pub mod half_matrix;
mod independent;
mod inverse_stiffness;
pub mod lanes;
pub mod mixed;
mod mixed_iteration;
mod mixed_scaling;
pub mod mixed_system;
pub mod multigrid;
pub mod ordering;
pub mod preconditioned;
pub mod pressed_curvature;
mod report;
pub mod row_ordering;
mod scaling;
pub mod slots;
pub mod sparse_rows;
pub mod stationary;
mod system;
mod vector;
pub use choice::{Solver, solve};
pub use half_matrix::HalfMatrix;
pub use report::{LoadStep, NewtonReport, RestOnTheWay, SolveReport};
pub use system::{Block, PartlyHeld, Solution, SolverError, System, Tolerance, Unknowns, tell};
