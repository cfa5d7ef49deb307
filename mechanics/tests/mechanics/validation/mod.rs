//! Distances and comparisons of surfaces.

pub mod comparison;
pub mod distances;
