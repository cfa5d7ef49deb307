//! Inverse planning: targets on the skin, the plan that reaches them, and the skin of that plan.

mod input;
mod job;
mod targets;
mod tissue;

pub use input::OptimiseInput;
pub use job::optimise_job;
