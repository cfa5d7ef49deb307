//! Meshes: quality, and the report of a check.

mod check;
mod quality;
