//! `facies slot`: the process of one slot. It is started by `facies serve` and talks to nobody else.

use clap::Args;

use crate::config::LogConfig;
use crate::telemetry;
use crate::worker::process::{SlotError, serve};

#[derive(Debug, Args)]
pub struct Arguments {
    /// What is told on standard error
    #[arg(long, value_name = "FILTER", default_value = "info")]
    log_level: String,
}

/// Serves until standard input is closed.
pub fn run(arguments: &Arguments) -> Result<(), SlotError> {
    let log = LogConfig { json: false, filter: arguments.log_level.clone() };
    // The worker has read the same filter.
    if let Err(error) = telemetry::start(&log) {
        eprintln!("{error}");
    }
    serve()
}
