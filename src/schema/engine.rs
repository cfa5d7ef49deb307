//! The program that computes, as results and states of jobs name it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::NUMERICS_REVISION;

/// The program that computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct EngineDocument {
    pub name: String,
    pub version: String,
    /// Raised with every change of its numbers; jobs of another revision are other jobs. 0 of results from before
    /// there were revisions.
    #[serde(default)]
    pub numerics: u32,
    /// Processor and operating system.
    pub target: String,
    /// `release` or `debug`.
    pub profile: String,
}

impl EngineDocument {
    /// The program that is running.
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
