//! The spec of a prediction, its methods, its check, and its result.

pub mod check;
pub mod document;
pub mod dvs;
pub mod keep;
pub mod mass_spring;
pub mod mass_tensor;
pub mod result;
pub mod thickness_warp;
