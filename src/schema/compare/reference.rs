//! The surfaces that a comparison names.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A surface: exactly one of the predicted skin of a `job` and a `mesh`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceReference {
    /// The id of a successful prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// The id of a mesh; of a volume mesh the boundary is compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh: Option<String>,
}

/// A mesh by its id; of a volume mesh the boundary is compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshReference {
    pub mesh: String,
}
