//! A refusal: a stable code, a sentence, the places and the numbers (RFC 9457).

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use super::pointer::FieldError;

/// Why something was refused. Which HTTP status belongs to a code is the business of the API.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The last word of the problem's `type`, e.g. `validation-failed`.
    pub code: &'static str,
    pub detail: String,
    pub errors: Vec<FieldError>,
    /// Members beside the standard ones, e.g. `line` and `column`.
    pub members: Map<String, Value>,
}

impl Problem {
    pub fn new(code: &'static str, detail: impl Into<String>) -> Self {
        Problem { code, detail: detail.into(), errors: Vec::new(), members: Map::new() }
    }

    /// The same problem with one more member.
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.members.insert(name.to_owned(), value.into());
        self
    }

    /// The same problem with pointers that start at `from` starting at `to` instead: a body that is
    /// itself the plan knows nothing of `/plan`.
    pub fn moved(mut self, from: &str, to: &str) -> Self {
        for error in &mut self.errors {
            if let Some(rest) = error.pointer.strip_prefix(from)
                && (rest.is_empty() || rest.starts_with('/'))
            {
                error.pointer = format!("{to}{rest}");
            }
        }
        self
    }

    /// The body of an answer with this problem.
    pub fn into_document(self, kind: ProblemKind, instance: Option<String>) -> ProblemDocument {
        ProblemDocument {
            kind: format!("{}{}", kind.base, self.code),
            title: kind.title,
            status: kind.status,
            code: self.code.to_owned(),
            detail: self.detail,
            instance,
            errors: self.errors,
            members: self.members,
        }
    }
}

/// What the API knows about the kind of a problem.
pub struct ProblemKind {
    /// What stands before the code in `type`.
    pub base: String,
    pub title: String,
    pub status: u16,
}

/// `application/problem+json` (RFC 9457).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ProblemDocument {
    /// URI of the kind of problem; ends with `code`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind of problem in a few words.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// A stable word for the kind of problem.
    pub code: String,
    /// What was wrong here, in one sentence with the numbers.
    pub detail: String,
    /// The request, by its id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub instance: Option<String>,
    /// Everything wrong with the document, at most 50 entries.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
    /// Further members that belong to the code, e.g. `line` and `column` of `malformed-json`.
    #[serde(flatten)]
    #[schema(value_type = Object)]
    pub members: Map<String, Value>,
}
