//! Subjects of a study: scenes and plans, by name or in full.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::plan::document::PlanDocument;
use crate::schema::wire::text_or_object::TextOrObject;

/// A built-in scene, by its name (`sphere`, `slab`, `slab_hex`, `half_head`, and moved by up to 25 mm
/// `slab_far` and `half_head_far`), or a case.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum SceneReference {
    Name(String),
    Case(CaseReference),
}

/// A case by its id.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseReference {
    pub case: String,
    /// Its name in rows and charts. Default: the name of the case, or its place in the list.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    /// The series of this case. Cases of one series are the same face on meshes of different cell sizes: the report
    /// has the convergence of the skin over them (`cell_sizes`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub series: Option<String>,
    /// Plans of this case only. Default: the plans in full of the study.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plans: Vec<PlanDocument>,
}

/// A plan for cases, or the name of a plan of a scene by name.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum PlanReference {
    Name(String),
    Plan(Box<PlanDocument>),
}

impl<'de> Deserialize<'de> for SceneReference {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match TextOrObject::deserialize(deserializer)? {
            TextOrObject::Text(name) => SceneReference::Name(name),
            TextOrObject::Object(case) => SceneReference::Case(case),
        })
    }
}

impl<'de> Deserialize<'de> for PlanReference {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match TextOrObject::deserialize(deserializer)? {
            TextOrObject::Text(name) => PlanReference::Name(name),
            TextOrObject::Object(plan) => PlanReference::Plan(plan),
        })
    }
}
