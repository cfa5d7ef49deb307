//! Places in a document as JSON pointers, and a fault at a place.

use std::fmt;

use serde::Serialize;
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;

/// A JSON pointer (RFC 6901).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pointer(String);

impl Pointer {
    /// The document itself.
    pub fn root() -> Self {
        Pointer::default()
    }

    /// A pointer in its text form.
    pub fn from_text(text: &str) -> Self {
        Pointer(text.to_owned())
    }

    /// A member of an object here.
    pub fn key(&self, name: &str) -> Pointer {
        let escaped = name.replace('~', "~0").replace('/', "~1");
        Pointer(format!("{}/{escaped}", self.0))
    }

    /// An entry of an array here.
    pub fn index(&self, index: usize) -> Pointer {
        Pointer(format!("{}/{index}", self.0))
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Pointer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// A fault of a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct FieldError {
    /// JSON pointer (RFC 6901) to the place.
    pub pointer: String,
    /// The stable code of the mistake.
    #[schema(value_type = String)]
    pub code: ErrorCode,
    /// One sentence with the numbers.
    pub detail: String,
}

impl FieldError {
    /// The mistake with its place, as one sentence.
    pub fn sentence(&self) -> String {
        let place = if self.pointer.is_empty() { "the document" } else { &self.pointer };
        format!("{place}: {}", self.detail)
    }
}
