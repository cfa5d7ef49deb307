//! Contact of the boundary with itself and with bone: which points of it face each other, and how far apart they are.

mod bone;
mod bone_inside;
mod facing;
mod fold;
mod line;
mod moved_boundary;
mod row;

pub use bone::BoneSurface;
pub use bone_inside::{BoneInside, Embedded, bones_inside};
pub use facing::{CLOSED_MM, FacingSurfaces};
pub use row::{Alike, ContactRow, OnBone, with_pressing};
