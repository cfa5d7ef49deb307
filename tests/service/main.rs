//! The service from outside: the real server, its store, its queue.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod api;
mod command;
#[path = "../support/deployments.rs"]
mod deployments;
mod faults;
#[allow(dead_code, reason = "the tests under fire use the rest")]
#[path = "../support/helpers.rs"]
mod helpers;
#[allow(dead_code, reason = "the tests under fire use the rest")]
#[path = "../support/invariants.rs"]
mod invariants;
#[path = "../support/partition.rs"]
mod partition;
#[allow(dead_code, reason = "the tests under fire use the rest")]
#[path = "../support/processes.rs"]
mod processes;
#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../../mechanics/tests/support/samples.rs"]
mod samples;
#[path = "../../mechanics/tests/support/data.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod shared;
mod store;
mod traces;
mod worker;
