//! From a job document to result files: one path for the service and for the command line.
//! Around it, for the service: the meshes in memory, the queue's workers and their signs of life.

pub mod clock;
pub mod compare;
pub mod failure;
pub mod optimise;
pub mod predict;
pub mod response;
pub mod result;
pub mod source;
pub mod study;
pub mod work;

pub use failure::JobError;
pub use optimise::OptimiseInput;
pub use predict::check::{CheckReport, check};
pub use predict::input::{CompareInput, JobInput, PredictInput};
pub use response::ResponseInput;
pub use source::{MeshSource, SourceError, StoredMesh, StoredShape};
pub use study::StudyInput;
pub use work::{JobOutput, work};
