//! Meshes that a prediction stores as if uploaded, for use in other cases.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::link::Link;

/// A mesh of a prediction that can be stored, in mm in the frame of the case.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum KeptName {
    /// The predicted skin, a surface.
    Skin,
    /// The deformed volume mesh of the case. Sets, labels and fibre directions are
    /// those of the case.
    Volume,
}

/// A mesh that a job stores, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MadeName {
    Skin,
    Volume,
    /// The surface of a segment.
    Bone,
    /// The surface of a muscle.
    Muscle,
}

impl MadeName {
    pub fn name(self) -> &'static str {
        match self {
            MadeName::Skin => "skin",
            MadeName::Volume => "volume",
            MadeName::Bone => "bone",
            MadeName::Muscle => "muscle",
        }
    }
}

impl From<KeptName> for MadeName {
    fn from(name: KeptName) -> Self {
        match name {
            KeptName::Skin => MadeName::Skin,
            KeptName::Volume => MadeName::Volume,
        }
    }
}

/// A stored mesh. It is erased with the job or its case, unless something else refers to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct KeptMeshDocument {
    pub what: MadeName,
    /// Of a bone the name of its segment, of a muscle its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    /// The id of the mesh.
    pub mesh: String,
    pub link: Link,
}

impl KeptMeshDocument {
    pub fn new(what: MadeName, name: Option<String>, mesh: &str) -> Self {
        let link = Link {
            href: format!("/v1/meshes/{mesh}"),
            rel: "item".to_owned(),
            media_type: "application/json".to_owned(),
        };
        KeptMeshDocument { what, name, mesh: mesh.to_owned(), link }
    }
}
