//! Documents and jobs, without a server.

#![allow(clippy::unwrap_used)]

#[path = "../../mechanics/tests/support/data.rs"]
mod shared;

#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../../mechanics/tests/support/samples.rs"]
mod samples;

mod fuzz;
mod jobs;
mod schema;
