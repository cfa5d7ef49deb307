//! Linear solvers against each other, and how they fail.

pub mod hard_systems;
pub mod solvers;
