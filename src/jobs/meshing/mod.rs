//! Meshing: from an image or surfaces to a volume mesh with its node sets, and the case that it is made for.

mod body;
mod case;
mod input;
mod job;

pub use input::MeshingInput;
pub use job::meshing_job;
