//! Jobs, from document to result files: one path for the service and for the command line.

mod clock;
mod cohort;
mod compare;
mod drawing;
mod failure;
mod fetch;
mod input;
mod meshing;
mod optimise;
mod output;
mod predict;
mod reproduce;
pub mod response;
pub mod result;
mod run;
mod scale;
mod source;
pub mod study;

pub use cohort::CohortInput;
pub use compare::CompareInput;
pub use drawing::Finished;
pub use failure::JobError;
pub use input::JobInput;
pub use meshing::{MeshingInput, WaitingCase};
pub use optimise::OptimiseInput;
pub use output::{JobOutput, MadeMesh, Workplace};
pub use predict::{CheckReport, PredictInput, check};
pub use reproduce::ReproduceInput;
pub use response::ResponseInput;
pub use run::work;
pub use scale::MeshSize;
pub use source::{MeshSource, SourceError, StoredMesh, StoredShape};
pub use study::StudyInput;
