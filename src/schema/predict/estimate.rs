//! Setting that errors of the mesh are estimated, or not.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// `auto` estimates the discretisation error with every method for which that is possible; `none` saves the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum EstimateName {
    #[default]
    Auto,
    None,
}

impl EstimateName {
    /// What is not written down.
    pub(super) fn is_default(&self) -> bool {
        *self == EstimateName::Auto
    }
}
