//! Resources over HTTP.

mod admission;
mod bad_documents;
mod bad_meshes;
mod bad_requests;
mod batch;
mod case_page;
mod cases;
mod clients_that_stall;
mod error_codes;
mod events;
mod examples;
mod held;
mod idempotency;
mod images;
mod jobs;
mod keep;
mod meshes;
mod openapi;
mod optimise;
mod origins;
mod pages;
mod plans;
mod response;
mod study;
mod tenants;
mod watching;
