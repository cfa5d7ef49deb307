//! Virtual cohorts: operated faces that the program makes itself, with a truth that is richer than the models.

mod face;
mod noise;
mod operation;
mod patient;
mod report;
mod tissue;
mod twins;

pub use noise::USUAL_MAPPING;
pub use patient::{Making, VirtualError, VirtualPatient};
pub use report::{VirtualCohort, virtual_cohort};
pub use twins::{PARTS, Twin, VARIANTS, Variant, twins};
