//! Errors in a NIfTI file, with their byte.

use crate::format::error::{FilePosition, FormatError};

pub(super) const FORMAT: &str = "NIfTI";

pub(super) fn bad(at: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: FilePosition::Offset(at), detail: detail.into() }
}
