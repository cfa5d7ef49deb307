//! Predictions: documents and meshes checked, the expected cost, and what a plan pushes into what.

pub mod check;
pub mod cost;
pub mod input;
pub mod overlap;

pub use check::{CheckReport, check};
