//! The spec of a cohort and its result, and stored cohorts.

pub mod document;
pub mod result;
pub mod stored;
