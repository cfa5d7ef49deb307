//! Comparisons of two surfaces, as a separate job or as a part of a prediction.

mod input;
mod job;
mod meshes;
mod picture;
mod surfaces;

pub use input::CompareInput;
pub use job::compare_job;
pub use meshes::{ComparedMeshes, surface_of};
pub use surfaces::{ComparisonFindings, Pair, admit, by_landmarks, place_of};
