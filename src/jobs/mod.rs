//! From a job document to result files: one path for the service and for the command line.

pub mod check;
pub mod comparison;
pub mod failure;
pub mod input;
pub mod observed;
mod output;
mod pictures;
mod provenance;
pub mod report;
mod skin_files;
pub mod source;
mod tissue_files;
pub mod work;

pub use check::{CheckReport, check};
pub use failure::JobError;
pub use input::{CompareInput, JobInput, PredictInput};
pub use source::{MeshSource, SourceError, StoredMesh, StoredShape};
pub use work::{JobOutput, work};
