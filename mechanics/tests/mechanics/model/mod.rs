//! Models: springs, mass-tensors, splines, membranes, and the order of convergence.

mod convergence;
mod finite_strain;
mod finite_strain_in_parts;
mod finite_strain_in_steps;
mod finite_strain_laws;
mod force_series;
mod linear_system;
mod mass_spring;
mod mass_tensor;
mod mass_tensor_nonlinear;
mod membrane;
mod spline_axes;
mod spline_stepping;
mod spline_volume;
mod stability;
mod thickness_warp;
