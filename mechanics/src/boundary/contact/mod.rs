//! Contact of the boundary with itself: which points of it face each other, and how far apart they are.

mod facing;
mod line;
mod moved_boundary;
mod row;

pub use facing::{CLOSED_MM, FacingSurfaces};
pub use row::{ContactRow, with_pressing};
