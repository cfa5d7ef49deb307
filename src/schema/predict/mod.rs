//! The spec of a prediction, its methods, its check, and its result.

pub mod budget;
pub mod check;
pub mod contact;
pub mod document;
pub mod dvs;
pub mod mass_spring;
pub mod mass_tensor;
pub mod output;
pub mod result;
pub mod thickness_warp;
pub mod tolerance;
