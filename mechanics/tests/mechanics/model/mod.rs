//! Models: springs, mass-tensors, splines, membranes, and the order of convergence.

pub mod convergence;
pub mod mass_spring;
pub mod mass_tensor;
pub mod membrane;
pub mod spline_stepping;
pub mod spline_volume;
pub mod thickness_warp;
