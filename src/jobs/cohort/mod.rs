//! Cohorts: comparisons of the same subjects by several methods.

mod files;
mod groups;
mod input;
mod job;
mod subjects;
mod twins;

pub use input::CohortInput;
pub use job::{cohort_job, tested_pair};
