//! The service from outside: the real server, its store, its queue.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod admission;
mod audit;
mod bad_documents;
mod bad_meshes;
mod bad_requests;
mod batch;
mod broken_disk;
mod cases;
mod clients_that_stall;
mod clocks;
mod demo;
mod deployments;
mod erasures;
mod events;
mod faults;
#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../mechanics/formats_samples.rs"]
mod formats_samples;
#[allow(dead_code, reason = "the tests under fire use the rest")]
mod helpers;
mod hosts;
mod idempotency;
mod images;
#[allow(dead_code, reason = "the tests under fire use the rest")]
#[path = "../chaos/invariants.rs"]
mod invariants;
mod jobs;
mod lost_jobs;
mod meshes;
mod openapi;
mod optimise;
mod origins;
mod outages;
mod pages;
mod partition;
mod plans;
#[allow(dead_code, reason = "the tests under fire use the rest")]
#[path = "../chaos/processes.rs"]
mod processes;
mod queue;
mod races;
mod remembered;
mod response;
mod schema_steps;
mod settings;
#[path = "../shared/mod.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod shared;
mod storage;
mod study;
mod tenants;
mod traces;
mod transfer;
mod watching;
mod worker;
