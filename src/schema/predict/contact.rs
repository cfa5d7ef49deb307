//! Contact: whether tissue is held where it slides.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What happens at the sliding sets of the case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactName {
    /// Held across, free along.
    #[default]
    Sliding,
    /// Free.
    None,
}
