//! Conformation of a template as a job.

mod input;
mod job;
mod tissue;

pub use input::ConformInput;
pub use job::conform_job;
