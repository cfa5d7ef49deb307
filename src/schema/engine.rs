//! The program and its version, in results and states of jobs.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::NUMERICS_REVISION;

/// The program that computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct EngineDocument {
    pub name: String,
    pub version: String,
    /// Raised with every change of its numbers; it is part of the hash of a job. 0 in results older than
    /// revisions.
    #[serde(default)]
    pub numerics: u32,
    /// Processor and operating system.
    pub target: String,
    /// `release` or `debug`.
    pub profile: String,
}

impl EngineDocument {
    /// The running program.
    pub fn this() -> Self {
        let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
        EngineDocument {
            name: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            numerics: NUMERICS_REVISION,
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            profile: profile.to_owned(),
        }
    }
}
