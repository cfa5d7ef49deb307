//! Laws of one material point.

pub mod anisotropy;
mod hyperelastic;
