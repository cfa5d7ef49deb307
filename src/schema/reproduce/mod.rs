//! The spec of the reproduction of an operation and its result.

pub mod document;
pub mod result;
