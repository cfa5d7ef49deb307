//! Distances and comparisons of surfaces.

mod comparison;
mod distances;
mod scans;
