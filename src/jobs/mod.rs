//! From a job document to result files: one path for the service and for the command line.
//! Around it, for the service: the meshes in memory, the queue's workers and their signs of life.

mod batch;
pub mod check;
pub mod comparison;
pub mod expected;
pub mod fail_point;
pub mod failure;
pub mod heartbeat;
pub mod input;
pub mod judgement;
pub mod library;
mod mesh_cache;
pub mod niceness;
pub mod numerics;
pub mod observed;
pub mod optimisation;
mod optimise_targets;
mod output;
mod overlap;
mod pictures;
mod provenance;
pub mod report;
pub mod response;
pub mod responses;
mod skin_files;
pub mod slot;
pub mod source;
pub mod stopwatch;
pub mod study;
mod study_chart;
pub mod study_files;
pub mod study_report;
mod study_scenes;
mod study_truth;
mod tissue_files;
pub mod upload;
pub mod work;
pub mod worker;

pub use check::{CheckReport, check};
pub use failure::JobError;
pub use input::{CompareInput, JobInput, PredictInput};
pub use optimisation::OptimiseInput;
pub use response::ResponseInput;
pub use source::{MeshSource, SourceError, StoredMesh, StoredShape};
pub use study::StudyInput;
pub use work::{JobOutput, work};
