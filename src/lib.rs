//! facies predicts how a face will look after the bones under it are moved.
//!
//! The modules stand in the order of the path that a job takes; ARCHITECTURE.md tells who may use whom.

pub mod api;
pub mod boundary;
pub mod chart;
pub mod command;
pub mod config;
pub mod element;
pub mod format;
pub mod jobs;
pub mod material;
pub mod mesh;
pub mod model;
pub mod plan;
pub mod prediction;
pub mod registration;
pub mod schema;
pub mod solver;
pub mod store;
pub mod telemetry;
pub mod validation;
