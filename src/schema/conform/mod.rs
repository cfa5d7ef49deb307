//! Documents of a conformation of a template mesh to a patient.

pub mod document;
pub mod result;
pub mod template;
