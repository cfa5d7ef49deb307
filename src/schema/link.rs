//! Links from one resource to another.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A link to a related resource (RFC 8288).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Link {
    pub href: String,
    pub rel: String,
    #[serde(rename = "type")]
    pub media_type: String,
}
