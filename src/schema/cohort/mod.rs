//! The spec of a cohort and its result, and cohorts that are kept.

pub mod document;
pub mod result;
pub mod stored;
