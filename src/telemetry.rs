//! Structured logs on standard error.

mod standard_error;

use tracing_subscriber::filter::Targets;
use tracing_subscriber::prelude::*;

use crate::config::LogConfig;
use standard_error::Lines;

#[derive(Debug, thiserror::Error)]
pub enum TelemetryError {
    #[error("log-level is `{0}`, and has to be a level or a filter such as facies=debug,sqlx=warn")]
    Filter(String),
    #[error("logs are already set up")]
    AlreadySet,
}

/// Starts the logs of this process: one line for each event, as JSON or as text.
pub fn start(log: &LogConfig) -> Result<(), TelemetryError> {
    let filter: Targets =
        log.filter.parse().map_err(|_| TelemetryError::Filter(log.filter.clone()))?;
    let lines = tracing_subscriber::fmt::layer().with_writer(|| Lines);
    let set = if log.json {
        let json = lines.json().flatten_event(true).with_current_span(true).with_span_list(false);
        tracing_subscriber::registry().with(json.with_filter(filter)).try_init()
    } else {
        let text = lines.with_ansi(false);
        tracing_subscriber::registry().with(text.with_filter(filter)).try_init()
    };
    set.map_err(|_| TelemetryError::AlreadySet)
}
