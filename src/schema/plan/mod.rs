//! The plan document, its movements and loads, growth and muscles.

pub mod document;
mod doubt;
pub mod inner;
pub mod load;
pub mod movement;
