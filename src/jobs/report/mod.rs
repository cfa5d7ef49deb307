//! Printable reports of results: the plan, the outcome, its errors and its provenance.

mod comparison;
mod content;
mod directions;
mod form;
mod html;
mod load_steps;
mod method;
mod pages;
mod prediction;
mod room;
mod study;
mod tables;
mod warnings;
mod words;

pub use comparison::{ComparisonFacts, SIGNED_RANGE_MM, comparison_report};
pub use content::Report;
pub use form::ReportForm;
pub use prediction::{PredictionFacts, prediction_report, write_reports};
pub use study::{StudyFacts, study_report};
