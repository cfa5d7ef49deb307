//! Predictions: checks of documents and meshes, the expected cost, and collisions under a plan.

mod check;
mod comparison;
mod correction;
mod cost;
mod density;
mod expectation;
mod facing;
mod far_from_origin;
mod files;
mod fitted_model;
mod input;
mod job;
mod made;
mod overlap;
mod planned;
mod publish;
mod refinable;
mod unknown_names;

pub use check::{CheckReport, check};
pub use input::{PredictInput, Prepared};
pub use job::predict_job;
pub use made::check_made;
pub use publish::{Predicted, statistics};
