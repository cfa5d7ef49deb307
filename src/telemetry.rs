//! Structured logs on standard error.

mod standard_error;

use tracing_subscriber::EnvFilter;

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
    let filter =
        EnvFilter::try_new(&log.filter).map_err(|_| TelemetryError::Filter(log.filter.clone()))?;
    let lines = tracing_subscriber::fmt().with_env_filter(filter).with_writer(|| Lines);
    let set = if log.json {
        lines.json().flatten_event(true).with_current_span(true).with_span_list(false).try_init()
    } else {
        lines.with_ansi(false).try_init()
    };
    set.map_err(|_| TelemetryError::AlreadySet)
}
