//! Secrets that no log shows, and errors of settings.

use std::net::SocketAddr;
use std::path::PathBuf;

/// A text that never reaches a log.
#[derive(Clone, PartialEq)]
pub struct Secret(pub(super) String);

impl Secret {
    pub fn new(text: String) -> Secret {
        Secret(text)
    }

    /// The secret itself.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// Compares in a time that depends on the length only.
    pub fn matches(&self, other: &str) -> bool {
        let (own, other) = (self.0.as_bytes(), other.as_bytes());
        own.len() == other.len()
            && own.iter().zip(other).fold(0, |difference, (a, b)| difference | (a ^ b)) == 0
    }
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("…")
    }
}

#[derive(Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    #[error("{name} is `{value}`; it takes: {wanted}")]
    Value { name: &'static str, value: String, wanted: &'static str },
    #[error("{0} has to have 16 to 255 visible characters")]
    Key(&'static str),
    #[error(
        "heartbeat-s is {heartbeat} and lease-s {lease}: a lease has to outlast two heartbeats"
    )]
    Heartbeat { heartbeat: f64, lease: f64 },
    #[error("database has to begin with postgres:// or postgresql://")]
    Database,
    #[error(
        "database has an `@` behind a `/`, `?` or `#`: in a user or password these are written %2F, %3F and %23, an `@` behind them %40"
    )]
    DatabasePassword,
    #[error("database is `{address}`, which is no address of a PostgreSQL: {reason}")]
    DatabaseAddress { address: String, reason: String },
    #[error("{name} is `{}`: {} is no folder", folder.display(), at.display())]
    NoFolder { name: &'static str, folder: PathBuf, at: PathBuf },
    #[error(
        "{name} is not set: a worker of its own shares the database and the blobs with the API, \
         and what is in the data folder belongs to one process"
    )]
    NotShared { name: &'static str },
    #[error("{}: {reason}", path.display())]
    File { path: PathBuf, reason: String },
    #[error(
        "bind is {0}, which others can reach: set an api-key, or ask-for-keys to true, or bind to 127.0.0.1"
    )]
    OpenWithoutKey(SocketAddr),
    #[error("bind and admin-bind are both {0}: each needs a port of its own")]
    SameListeners(SocketAddr),
}
