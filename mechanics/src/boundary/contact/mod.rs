//! Contact of the boundary with itself: which points of it face each other, and how far apart they are.

mod facing;
mod line;
mod moved_boundary;
mod row;

pub use facing::FacingSurfaces;
pub use row::ContactRow;
