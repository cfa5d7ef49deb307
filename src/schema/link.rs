//! Links from one resource to another.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Where to go from here (RFC 8288).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Link {
    pub href: String,
    pub rel: String,
    #[serde(rename = "type")]
    pub media_type: String,
}
