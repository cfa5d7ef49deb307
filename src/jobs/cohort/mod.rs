//! Cohorts: comparisons of the same subjects by several methods.

mod input;
mod job;
mod subjects;

pub use input::CohortInput;
pub use job::{cohort_job, tested_pair};
