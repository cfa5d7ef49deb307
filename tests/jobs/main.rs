//! Documents and jobs, without a server.

#![allow(clippy::unwrap_used)]

#[path = "../../mechanics/tests/support/data.rs"]
mod shared;

#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../../mechanics/tests/support/samples.rs"]
mod samples;

#[allow(dead_code, reason = "the tests of the numerics use the rest")]
#[path = "../../mechanics/tests/mechanics/scenes.rs"]
mod scenes;

mod fuzz;
mod ignored_arrays;
mod jobs;
mod schema;
