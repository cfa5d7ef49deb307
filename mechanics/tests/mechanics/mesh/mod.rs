//! Meshes: quality, and the report of a check.

mod bisection;
mod check;
mod conformity;
mod quality;
