//! Laws of one material point.

pub mod anisotropy;
mod closed_forms;
pub mod hyperelastic;
