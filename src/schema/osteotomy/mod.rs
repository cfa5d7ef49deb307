//! The cuts of a plan and the segments that they separate from the bone of a scan.

pub mod conversion;
pub mod document;
mod polyline;
mod risks;

pub use document::{CutDocument, CutSegmentDocument, OsteotomyDocument};
