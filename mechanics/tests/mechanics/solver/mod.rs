//! Linear solvers against each other, and how they fail.

mod hard_systems;
pub mod solvers;
