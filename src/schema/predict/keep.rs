//! Meshes that a prediction keeps: stored as if they had been uploaded, for use in other cases.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::link::Link;

/// A mesh of a prediction that can be kept, in mm in the frame of the case.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum KeptName {
    /// The predicted skin, a surface.
    Skin,
    /// The volume mesh of the case with every node where the prediction has it. Sets, labels and fibre directions are
    /// those of the case.
    Volume,
}

impl KeptName {
    pub fn name(self) -> &'static str {
        match self {
            KeptName::Skin => "skin",
            KeptName::Volume => "volume",
        }
    }
}

/// A mesh that was kept. It goes with the job or its case, unless something else refers to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct KeptMeshDocument {
    pub what: KeptName,
    /// The id of the mesh.
    pub mesh: String,
    pub link: Link,
}

impl KeptMeshDocument {
    pub fn new(what: KeptName, mesh: &str) -> Self {
        let link = Link {
            href: format!("/v1/meshes/{mesh}"),
            rel: "item".to_owned(),
            media_type: "application/json".to_owned(),
        };
        KeptMeshDocument { what, mesh: mesh.to_owned(), link }
    }
}
