//! The service under fire: real processes that are killed, stopped and starved at named points, and what must hold
//! afterwards. The invariants are those of `invariants.rs`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod deaths;
mod delays;
#[allow(dead_code, unused_imports, unused_macros, reason = "the tests of the service use the rest")]
#[path = "../support/deployments.rs"]
mod deployments;
#[allow(dead_code, reason = "the tests of the service use the rest")]
#[path = "../support/helpers.rs"]
mod helpers;
#[path = "../support/invariants.rs"]
mod invariants;
#[path = "../support/processes.rs"]
mod processes;
mod races;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../../mechanics/tests/support/data.rs"]
mod shared;
