//! DICOM: the slices of a series as one image in LPS.
//!
//! Source: PS3.3 (image plane and CT image modules), PS3.5 (data structures and encoding), PS3.10 (files). Of the
//! attributes those are read that decide the numbers and their place, and whether slices belong together; names and identifiers of a
//! patient are compared alone, and stand in no message.

mod attributes;
mod element;
mod identity;
mod jpeg_huffman;
mod jpeg_lossless;
mod padding;
mod pixel_layout;
mod pixels;
mod rle;
mod series;
mod slice;
mod stack;
mod transfer_syntax;

use super::ReadMesh;
use super::error::{FilePosition, FormatError};
use super::limits::ReadLimits;
pub(super) use series::assemble;
pub(super) use slice::{Part, read_part};

const FORMAT: &str = "DICOM";

/// Whether this is a file of PS3.10: a mark stands behind 128 bytes that say nothing.
pub(super) fn is_dicom(bytes: &[u8]) -> bool {
    bytes.get(128..132) == Some(b"DICM")
}

/// One file, which is an image in space only where it holds more than one slice.
pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    assemble(vec![read_part(bytes, 1, limits)?], limits)
}

fn bad(at: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: FilePosition::Offset(at), detail: detail.into() }
}
