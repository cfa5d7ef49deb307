//! Servers, deployments, processes and needs that the tests of several targets share.

#![allow(dead_code, unused_imports, unused_macros, reason = "each target uses a part")]

pub mod collector;
pub mod connections;
pub mod deployments;
#[path = "../../mechanics/tests/support/external.rs"]
pub mod external;
pub mod helpers;
pub mod invariants;
pub mod partition;
pub mod processes;
pub mod program;
pub mod rows;
#[path = "../../mechanics/tests/support/samples.rs"]
pub mod samples;
pub mod sources;
pub mod trials;
pub mod workers;
