//! Meshing: from an image or surfaces to a volume mesh with its node sets, and its case.

mod body;
mod case;
mod check;
mod cuts;
mod doubt;
mod input;
mod job;
mod model;
mod skin_scan;

pub use input::{MeshingInput, WaitingCase};
pub use job::meshing_job;
