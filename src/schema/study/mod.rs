//! The spec of a study or a batch, its check, and its report.

pub mod batch;
pub mod cell_sizes;
pub mod check;
pub mod constants;
pub mod document;
pub mod expected;
pub mod reference;
pub mod report;
pub mod scene;
pub mod truth;
pub mod verdict;
