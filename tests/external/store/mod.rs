//! Rows and bytes, on both engines.

pub mod commits;
pub mod erasure;
pub mod locks;
pub mod lost_jobs;
pub mod made;
pub mod meshings;
pub mod pages;
pub mod places;
pub mod queue;
pub mod races;
pub mod read_only;
pub mod remembered;
pub mod schema_steps;
pub mod storage;
pub mod tags;
pub mod tenants;
pub mod transfer;
pub mod turns;
