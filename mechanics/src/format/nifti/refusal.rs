//! Errors in a NIfTI file, with their byte.

use crate::format::error::{FormatError, Place};

pub(super) const FORMAT: &str = "NIfTI";

pub(super) fn bad(at: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: Place::Offset(at), detail: detail.into() }
}
