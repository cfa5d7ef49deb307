//! Jobs without a server: from documents to result files.

mod cohort;
mod comparisons;
mod cuts;
mod failures;
mod image;
mod learn;
mod optimise;
mod planning;
mod refined;
mod results;
mod stress;
mod study_report;
mod twin;
