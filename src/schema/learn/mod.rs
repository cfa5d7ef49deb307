//! The spec of what is learned from operated cases, its model and its result.

pub mod correspondence;
pub mod document;
pub mod made;
pub mod mechanics;
pub mod model;
pub mod result;
