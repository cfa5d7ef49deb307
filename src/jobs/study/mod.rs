//! Studies: many rows of scenes, plans, materials and models, measured and judged.

mod batch;
pub mod cell_sizes;
mod chart;
mod constants;
mod documents;
pub mod files;
mod input;
mod job;
mod prepare;
pub mod report;
mod scenes;
pub mod stopwatch;
mod truth;
pub mod verdict;
pub mod words;

pub use chart::{MARKED, chart, chart_drawing, estimates_chart};
pub use input::StudyInput;
pub use job::study_job;
pub use prepare::ALL_METHODS;
