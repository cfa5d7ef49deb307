//! Predicts how a face will look after the bones under it are moved: meshes, tissue, equations, solvers, comparisons.

pub mod boundary;
pub mod chart;
pub mod element;
pub mod format;
pub mod image;
pub mod material;
pub mod mesh;
pub mod model;
pub mod optimisation;
pub mod plan;
pub mod prediction;
pub mod progress;
pub mod registration;
pub mod response;
pub mod solver;
pub mod study;
pub mod validation;
