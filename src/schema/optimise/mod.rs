//! The spec of inverse planning and its result.

pub mod document;
mod doubts;
pub mod result;
pub mod target;
pub mod tissue;
