//! Documents and jobs, without a server.

#![allow(clippy::unwrap_used)]

#[path = "../support/answers.rs"]
mod answers;
mod fuzz;
mod ignored_arrays;
mod jobs;
#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../../mechanics/tests/support/samples.rs"]
mod samples;
#[allow(dead_code, reason = "the tests of the numerics use the rest")]
#[path = "../../mechanics/tests/support/scenes.rs"]
mod scenes;
mod schema;
#[path = "../support/sources.rs"]
mod sources;
#[path = "../../mechanics/tests/support/transforms.rs"]
mod transforms;
