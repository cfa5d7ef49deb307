//! Warnings: facts that a reader needs although the work was not refused.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use super::numbers::with_short_numbers;
use mechanics::mesh::Warning;

/// A stable code, a sentence, and the numbers behind it under their own names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WarningDocument {
    pub code: String,
    pub detail: String,
    #[serde(flatten)]
    #[schema(value_type = Object)]
    pub numbers: Map<String, Value>,
}

impl From<&Warning> for WarningDocument {
    fn from(warning: &Warning) -> Self {
        let finite = warning.numbers.iter().filter(|(_, value)| value.is_finite());
        WarningDocument {
            code: warning.code.to_owned(),
            detail: with_short_numbers(&warning.detail),
            numbers: finite.map(|&(name, value)| (name.to_owned(), value.into())).collect(),
        }
    }
}
