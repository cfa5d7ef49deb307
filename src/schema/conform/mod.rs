//! Documents of a conformation: a template mesh brought to a patient.

pub mod document;
pub mod result;
pub mod template;
