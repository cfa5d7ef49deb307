//! The spec of a prediction, its check, and its result.

pub mod adequacy;
pub mod budget;
pub mod check;
pub mod contact;
pub mod correction;
pub mod document;
pub mod estimate;
pub mod expectation;
pub mod keep;
pub mod newton;
pub mod nonlinearity;
pub mod output;
pub mod planned;
pub mod pressing;
pub mod refine;
pub mod result;
pub mod stress;
mod stress_asked;
pub mod time_band;
pub mod timing;
pub mod tissue_law;
pub mod tolerance;
