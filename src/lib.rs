//! facies predicts how a face will look after the bones under it are moved.
//!
//! The modules stand in the order of the path that a job takes; ARCHITECTURE.md tells who may use whom.

pub mod boundary;
pub mod config;
pub mod material;
pub mod element;
pub mod solver;
pub mod mesh;
pub mod plan;
pub mod model;
pub mod prediction;
pub mod schema;
pub mod store;
pub mod jobs;
pub mod telemetry;
