//! A refusal: a stable code, a sentence, the places and the numbers (RFC 9457).

use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

use super::numbers::with_short_numbers;
use super::pointer::FieldError;
use crate::schema::code::ErrorCode;

/// The prefix of the code in the `type` of a problem: the page of codes, relative to the request.
const KIND_BASE: &str = "/errors#";

/// The reason of a refusal.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The fragment of the problem's `type`, e.g. `validation-failed`.
    pub code: ErrorCode,
    pub detail: String,
    pub errors: Vec<FieldError>,
    /// Members beside the standard ones, e.g. `line` and `column`.
    pub members: Map<String, Value>,
}

impl Problem {
    /// Whether all mistakes of a document are of this kind.
    pub fn is_only(&self, code: ErrorCode) -> bool {
        !self.errors.is_empty() && self.errors.iter().all(|error| error.code == code)
    }

    pub fn new(code: ErrorCode, detail: impl Into<String>) -> Self {
        let detail = with_short_numbers(&detail.into());
        Problem { code, detail, errors: Vec::new(), members: Map::new() }
    }

    /// The same problem with one more member.
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.members.insert(name.to_owned(), value.into());
        self
    }

    /// The same problem with pointers that start at `from` starting at `to` instead: a body that is
    /// itself the plan has no `/plan`. The first place in the sentence is replaced too.
    pub fn moved(mut self, from: &str, to: &str) -> Self {
        let first = self.errors.first().map(FieldError::sentence);
        for error in &mut self.errors {
            if let Some(rest) = error.pointer.strip_prefix(from)
                && (rest.is_empty() || rest.starts_with('/'))
            {
                error.pointer = format!("{to}{rest}");
            }
        }
        let lead = first.as_ref().and_then(|first| self.detail.strip_suffix(first.as_str()));
        if let (Some(lead), Some(first)) = (lead, self.errors.first()) {
            self.detail = format!("{lead}{}", first.sentence());
        }
        self
    }

    /// The body of a response with this problem and this HTTP status.
    pub fn into_document(self, status: u16, instance: Option<String>) -> ProblemDocument {
        ProblemDocument {
            kind: format!("{KIND_BASE}{}", self.code),
            title: self.code.title().to_owned(),
            status,
            code: self.code.name().to_owned(),
            detail: self.detail,
            instance,
            errors: self.errors,
            members: self.members,
        }
    }
}

/// `application/problem+json` (RFC 9457).
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ProblemDocument {
    /// The address of the explanation, relative to the service; ends with `code`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind of problem in a few words.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// The stable code of the kind of problem.
    pub code: String,
    /// The fault of this request, in one sentence with the numbers.
    pub detail: String,
    /// The request, by its id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub instance: Option<String>,
    /// All faults of the document, at most 50.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
    /// Further members of the code, e.g. `line` and `column` of `malformed-json`.
    #[serde(flatten)]
    #[schema(value_type = Object)]
    pub members: Map<String, Value>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Faults, Pointer};

    #[test]
    fn a_number_with_hundreds_of_digits_is_told_in_short() {
        let mut faults = Faults::default();
        faults.check_range(&Pointer::root().key("finest_mm"), 1e300, 0.5..=50.0, "mm");
        let told = faults.into_result().unwrap_err();
        assert_eq!(told.detail, "/finest_mm: 1e300 mm is outside 0.5 to 50 mm");
        assert_eq!(told.errors[0].detail, "1e300 mm is outside 0.5 to 50 mm");
    }

    #[test]
    fn a_problem_that_is_moved_names_its_first_place_again_in_its_sentence() {
        let at = |text: &str| Pointer::from_text(text);
        let mut one = Faults::default();
        one.add(&at("/case/fixed/0"), ErrorCode::UnknownSet, "the mesh has no node set");
        let moved = one.into_result().unwrap_err().moved("/case", "");
        assert_eq!(moved.detail, "/fixed/0: the mesh has no node set");
        let mut two = Faults::default();
        two.add(&at("/case"), ErrorCode::Underconstrained, "loose");
        two.add(&at("/case/skin"), ErrorCode::UnknownSet, "missing");
        let moved = two.into_result().unwrap_err().moved("/case", "");
        assert_eq!(moved.detail, "2 mistakes, the first at the document: loose");
        assert_eq!(moved.errors[1].pointer, "/skin");
    }
}
