//! Predictions: documents and meshes checked, the expected cost, and what a plan pushes into what.

mod check;
mod comparison;
mod correction;
mod cost;
mod density;
mod expectation;
mod facing;
mod files;
mod fitted_model;
mod input;
mod job;
mod made;
mod overlap;
mod planned;
mod publish;
mod refinable;

pub use check::{CheckReport, check};
pub use input::{PredictInput, Prepared};
pub use job::predict_job;
pub use made::check_made;
pub use publish::{Predicted, statistics};
