//! facies predicts how a face will look after the bones under it are moved.
//!
//! A job takes the path `format`, `plan`, `boundary`, `model`, `solver`, `prediction`, `validation`; around it stand
//! `schema`, `store`, `jobs`, `api` and `command`. ARCHITECTURE.md tells who may use whom.

pub mod api;
pub mod command;
pub mod config;
pub mod fair_semaphore;
pub mod jobs;
pub mod library;
pub mod metrics;
pub mod schema;
pub mod store;
pub mod telemetry;
pub mod traces;
pub mod worker;
