//! The items of a batch: a study over an explicit list of predictions instead of all combinations.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

use crate::schema::case::material::MaterialDocuments;
use crate::schema::plan::document::PlanDocument;
use crate::schema::predict::document::PredictKind;

/// A `predict` spec in parts: its subject, and its model.
#[derive(Clone, Debug, PartialEq)]
pub struct ItemDocument {
    pub case: String,
    pub plan: Option<PlanDocument>,
    pub plan_id: Option<String>,
    /// Overrides the materials of the case, by member.
    pub materials: Option<MaterialDocuments>,
    /// Everything else: the method and its parameters; `label`, its name in rows.
    pub variant: Value,
}

const CASE: &str = "case";
const PLAN: &str = "plan";
const PLAN_ID: &str = "plan_id";
const MATERIALS: &str = "materials";

/// An item in JSON.
#[derive(Deserialize)]
struct Members {
    #[serde(default, rename = "kind")]
    _kind: PredictKind,
    case: String,
    plan: Option<PlanDocument>,
    plan_id: Option<String>,
    materials: Option<MaterialDocuments>,
    #[serde(flatten)]
    variant: Map<String, Value>,
}

impl<'de> Deserialize<'de> for ItemDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Members { _kind, case, plan, plan_id, materials, variant } =
            Members::deserialize(deserializer)?;
        Ok(ItemDocument { case, plan, plan_id, materials, variant: Value::Object(variant) })
    }
}

impl Serialize for ItemDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::Error;
        let mut members = self.variant.as_object().cloned().unwrap_or_default();
        members.insert(CASE.to_owned(), self.case.clone().into());
        let mut put = |name: &str, value: Result<Value, serde_json::Error>| {
            let value = value.map_err(S::Error::custom)?;
            if !value.is_null() {
                members.insert(name.to_owned(), value);
            }
            Ok(())
        };
        put(PLAN, serde_json::to_value(&self.plan))?;
        put(PLAN_ID, serde_json::to_value(&self.plan_id))?;
        put(MATERIALS, serde_json::to_value(&self.materials))?;
        members.serialize(serializer)
    }
}
