//! Jobs without a server: from documents to result files.

mod failures;
mod image;
mod optimise;
mod refined;
mod results;
mod study_report;
