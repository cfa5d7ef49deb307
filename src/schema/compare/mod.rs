//! The spec of a comparison and its result.

pub mod align;
pub mod document;
mod measures;
mod place;
mod reference;
pub mod result;
mod statistics;
