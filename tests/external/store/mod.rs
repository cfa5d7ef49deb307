//! Rows and bytes, on both engines.

pub mod lost_jobs;
pub mod made;
pub mod pages;
pub mod queue;
pub mod races;
pub mod remembered;
pub mod schema_steps;
pub mod storage;
pub mod tenants;
pub mod transfer;
