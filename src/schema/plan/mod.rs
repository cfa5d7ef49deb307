//! The plan document, its movements and loads.

pub mod document;
pub mod load;
pub mod movement;
