//! facies predicts how a face will look after the bones under it are moved.
//!
//! A job takes the path `format`, `plan`, `boundary`, `model`, `solver`, `prediction`, `validation`; around it stand
//! `schema`, `store`, `jobs`, `api` and `command`. ARCHITECTURE.md tells who may use whom.

pub mod api;
pub mod boundary;
pub mod chart;
pub mod command;
pub mod config;
pub mod element;
pub mod format;
pub mod image;
pub mod jobs;
pub mod material;
pub mod mesh;
pub mod metrics;
pub mod model;
pub mod optimisation;
pub mod plan;
pub mod prediction;
pub mod registration;
pub mod response;
pub mod schema;
pub mod solver;
pub mod store;
pub mod study;
pub mod telemetry;
pub mod traces;
pub mod validation;
