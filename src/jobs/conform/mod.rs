//! Conformation of a template as a job.

mod input;
mod job;

pub use input::ConformInput;
pub use job::conform_job;
