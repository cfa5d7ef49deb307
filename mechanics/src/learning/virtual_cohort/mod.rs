//! Virtual cohorts: operated faces that the program makes itself, with a truth that is richer than the models.

mod face;
mod generic;
mod noise;
mod operation;
mod patient;
mod report;
mod tissue;
mod twins;

pub use generic::PARTS;
pub use noise::USUAL_MAPPING;
pub use patient::{DrawnPatient, FaceKind, Making, Redrawn, VirtualError, VirtualPatient};
pub use report::{VirtualCohort, virtual_cohort};
pub use tissue::supposed;
pub use twins::{Twin, VARIANTS, Variant, twins};
