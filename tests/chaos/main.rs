//! The service under fire: real processes that are killed, stopped and starved at named points, and what must hold
//! afterwards. The invariants are those of `invariants.rs`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod deaths;
mod delays;
mod races;
#[path = "../support/mod.rs"]
mod support;

use support::{deployments, helpers, invariants, processes, samples};
