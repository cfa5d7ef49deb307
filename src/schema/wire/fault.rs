//! Errors in a document, all of them, each with its place.

use std::ops::RangeInclusive;

use serde_json::Map;

use super::letters::is_blank;
use super::numbers::with_short_numbers;
pub use super::pointer::{FieldError, Pointer};
use super::problem::Problem;
use crate::schema::code::ErrorCode;
use mechanics::prediction::SceneErrors;

/// The most reported faults of one document.
const REPORTED_FAULTS: usize = 50;

/// Codes that name a whole problem if a document has no other faults.
const CATALOGUE: &[ErrorCode] = &[
    ErrorCode::AlignmentFailed,
    ErrorCode::BoneOutsideSkin,
    ErrorCode::EmptySelection,
    ErrorCode::FrameConflict,
    ErrorCode::MethodMismatch,
    ErrorCode::MethodNotAvailable,
    ErrorCode::MissingMaterial,
    ErrorCode::NoInside,
    ErrorCode::NoTissue,
    ErrorCode::NotInResponse,
    ErrorCode::NotLinear,
    ErrorCode::NothingHeld,
    ErrorCode::PlanConflict,
    ErrorCode::PlanNotRigid,
    ErrorCode::PlanOutOfRange,
    ErrorCode::SegmentNotFound,
    ErrorCode::SlidingConflict,
    ErrorCode::Underconstrained,
    ErrorCode::UnknownSegment,
];

/// Collects faults, so that a client gets all of them at once.
#[derive(Debug, Default)]
pub struct Faults {
    errors: Vec<FieldError>,
    unreported: usize,
}

impl Faults {
    pub fn add(&mut self, at: &Pointer, code: ErrorCode, detail: impl Into<String>) {
        let detail = with_short_numbers(&detail.into());
        self.push(FieldError { pointer: at.to_string(), code, detail });
    }

    fn push(&mut self, error: FieldError) {
        if self.is_told(&error) {
            return;
        }
        if self.errors.len() == REPORTED_FAULTS {
            self.unreported += 1;
            return;
        }
        self.errors.push(error);
    }

    /// Whether the same was reported before; a member that is null is not also missing.
    fn is_told(&self, error: &FieldError) -> bool {
        self.errors.iter().any(|told| {
            let is_null =
                told.code == ErrorCode::NullValue && error.code == ErrorCode::MissingField;
            told == error || (is_null && told.pointer == error.pointer)
        })
    }

    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Whether further faults are counted only.
    pub fn is_full(&self) -> bool {
        self.errors.len() == REPORTED_FAULTS
    }

    /// `Ok` without faults. A problem has the code of its faults if all share one
    /// of the catalogue, else `validation-failed`.
    pub fn into_result(self) -> Result<(), Problem> {
        match self.errors.is_empty() {
            true => Ok(()),
            false => Err(self.into_problem()),
        }
    }

    fn into_problem(self) -> Problem {
        let shared =
            CATALOGUE.iter().find(|code| self.errors.iter().all(|error| error.code == **code));
        let count = self.errors.len() + self.unreported;
        let first = self.errors.first().map(FieldError::sentence).unwrap_or_default();
        let detail = match count {
            1 => first,
            _ => format!("{count} mistakes, the first at {first}"),
        };
        let code = shared.copied().unwrap_or(ErrorCode::ValidationFailed);
        Problem { code, detail, errors: self.errors, members: Map::new() }
    }

    /// Adds the faults of a problem; one without places is a mistake of the whole document.
    pub fn join(&mut self, problem: Problem) {
        let Problem { code, detail, errors, .. } = problem;
        if errors.is_empty() {
            self.push(FieldError { pointer: Pointer::root().to_string(), code, detail });
        }
        errors.into_iter().for_each(|error| self.push(error));
    }

    /// Refuses a number outside a closed range, and NaN.
    pub fn check_range(
        &mut self,
        at: &Pointer,
        value: f64,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> bool {
        let inside = range.contains(&value);
        if !inside {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let (low, high) = (range.start(), range.end());
            self.add(
                at,
                ErrorCode::OutOfRange,
                format!("{value}{unit} is outside {low} to {high}{unit}"),
            );
        }
        inside
    }

    /// Refuses names that are empty, too long, contain control characters, or nothing that is seen.
    pub fn check_name(&mut self, at: &Pointer, name: &str, longest: usize) {
        let characters = name.trim().chars().count();
        if characters == 0 || characters > longest {
            self.add(
                at,
                ErrorCode::BadName,
                format!("a name has 1 to {longest} characters, this one {characters}"),
            );
        } else if name.chars().any(char::is_control) {
            self.add(at, ErrorCode::BadName, "a name has no control characters");
        } else if is_blank(name) {
            let detail = "a name has letters that are seen, and this one has none";
            self.add(at, ErrorCode::BadName, detail);
        }
    }

    pub fn check_length(&mut self, at: &Pointer, length: usize, most: usize) {
        if length > most {
            self.add(
                at,
                ErrorCode::TooMany,
                format!("{length} entries, at most {most} are allowed"),
            );
        }
    }

    /// Refuses a choice without exactly one form.
    pub fn check_one_of(&mut self, at: &Pointer, given: usize, forms: &str) -> bool {
        if given != 1 {
            self.add(
                at,
                ErrorCode::OneOf,
                format!("exactly one of {forms} has to be given, here are {given}"),
            );
        }
        given == 1
    }
}

impl Problem {
    /// One mistake at one place of a document.
    pub fn at(pointer: &Pointer, code: ErrorCode, detail: impl Into<String>) -> Self {
        let mut faults = Faults::default();
        faults.add(pointer, code, detail);
        faults.into_problem()
    }
}

/// The refusal of a scene; its pointers start at `/case` or `/plan`.
impl From<SceneErrors> for Problem {
    fn from(errors: SceneErrors) -> Problem {
        let mut faults = Faults::default();
        for error in &errors.0 {
            faults.add(&Pointer::from_text(&error.pointer), error.code.into(), &error.detail);
        }
        faults.into_problem()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_letters_that_are_seen_in_whatever_direction_they_are_written() {
        let told = |name: &str| {
            let mut faults = Faults::default();
            faults.check_name(&Pointer::root().key("name"), name, 20);
            faults.into_result().err().map(|problem| problem.errors[0].detail.clone())
        };
        for unseen in ["\u{200b}", "\u{200d}\u{200c}", "\u{3164} \u{2800}", "\u{202e}\u{202c}"] {
            let detail = told(unseen).unwrap();
            assert_eq!(detail, "a name has letters that are seen, and this one has none");
        }
        let right_to_left = "\u{202b}\u{5de}\u{5d8}\u{5d5}\u{5e4}\u{5dc}\u{202c}";
        for name in ["maxilla", right_to_left, "\u{645}\u{6cc}\u{200c}\u{62e}\u{648}\u{627}"] {
            assert_eq!(told(name), None, "{name:?}");
        }
    }
}
