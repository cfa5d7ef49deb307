//! The service from outside: the real server, its store, its queue.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod api;
mod command;
mod faults;
#[path = "../support/mod.rs"]
mod support;
mod traces;
mod worker;

use support::{collector, connections, deployments, helpers, invariants, processes, rows, samples};
