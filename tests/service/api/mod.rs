//! Resources over HTTP.

pub mod admission;
pub mod audit;
pub mod bad_documents;
pub mod bad_meshes;
pub mod bad_requests;
pub mod batch;
pub mod cases;
pub mod clients_that_stall;
pub mod erasures;
pub mod events;
pub mod idempotency;
pub mod images;
pub mod jobs;
pub mod keep;
pub mod meshes;
pub mod openapi;
pub mod optimise;
pub mod origins;
pub mod plans;
pub mod response;
pub mod study;
pub mod tenants;
pub mod watching;
