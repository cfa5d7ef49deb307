//! Reproductions: the movements that an operation performed.

mod doubts;
mod input;
mod job;

pub use input::ReproduceInput;
pub use job::reproduce_job;
