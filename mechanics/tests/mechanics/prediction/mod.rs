//! Predictions against closed forms, published numbers and each other.

pub mod closed_form;
pub mod conditions;
pub mod elements;
pub mod fibres;
pub mod jump;
pub mod patch;
pub mod slab_table;
pub mod sliding;
