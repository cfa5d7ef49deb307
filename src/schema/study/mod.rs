//! The spec of a study or a batch, its check, and its report.

pub mod batch;
pub mod check;
pub mod document;
pub mod expected;
pub mod reference;
pub mod report;
