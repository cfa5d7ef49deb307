//! Finite elements: assembly, degrees of freedom with pressure, and the models that solve one matrix.

pub mod assembly;
pub mod cell_stiffness;
pub mod contact;
pub mod discretisation_error;
pub mod displacement;
pub mod displacement_pressure;
pub mod edge_nodes;
pub mod finite_strain;
pub mod force_series;
pub mod inner_stress;
pub mod law_states;
pub mod linear_states;
pub mod linear_system;
pub mod loads;
pub mod mass_tensor;
pub mod mass_tensor_nonlinear;
pub mod membrane;
pub mod quadratic;
mod stability;
pub mod strain;
mod stretched_membrane;
