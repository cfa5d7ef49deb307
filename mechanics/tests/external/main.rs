//! Numerics on what is not part of the project: real meshes, surfaces and images, and files of other programs.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod conformation;
mod estimates;
mod files;
mod interop;
mod lips;
mod muscle_mapping;
mod muscles;
mod needs;
mod predictions;
mod scans;
#[path = "../support/mod.rs"]
mod support;
mod surfaces;

use std::process::ExitCode;

use support::{samples, scenes};

fn main() -> ExitCode {
    support::external::run([
        conformation::trials(),
        estimates::trials(),
        files::trials(),
        interop::trials(),
        lips::trials(),
        muscle_mapping::trials(),
        muscles::trials(),
        needs::trials(),
        predictions::trials(),
        scans::trials(),
        surfaces::trials(),
    ])
}
