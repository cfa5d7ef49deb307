//! The spec of a cohort and its result.

pub mod document;
pub mod result;
