//! The spec of a comparison and its result.

pub mod document;
pub mod result;
