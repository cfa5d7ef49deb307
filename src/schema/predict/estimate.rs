//! Setting of the estimate of mesh errors.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// `auto` estimates the discretisation error for every method that supports it; `none` skips it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum EstimateName {
    #[default]
    Auto,
    None,
}

impl EstimateName {
    /// The default, which is not serialised.
    pub(super) fn is_default(&self) -> bool {
        *self == EstimateName::Auto
    }
}
