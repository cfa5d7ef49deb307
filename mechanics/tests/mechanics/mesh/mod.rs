//! Meshes: quality, and the report of a check.

pub mod check;
pub mod quality;
