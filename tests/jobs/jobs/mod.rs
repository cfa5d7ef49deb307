//! Jobs without a server: from documents to result files.

mod image;
mod optimise;
mod results;
mod study_report;
