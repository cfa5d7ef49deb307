//! The JSON documents of the service and the command line: units in the names, every value checked,
//! converted once to and from the types of the path (mm, ms, mg, mN, kPa, radians).

pub mod applied;
pub mod case;
pub mod code;
pub mod cohort;
pub mod compare;
pub mod engine;
pub mod hashes;
pub mod job;
pub mod job_change;
pub mod job_document;
pub mod key;
pub mod link;
pub mod mesh;
pub mod meshing;
pub mod methods;
mod numerics_code;
pub mod optimise;
pub mod osteotomy;
pub mod plan;
pub mod predict;
pub mod reproduce;
pub mod response;
pub mod response_part;
pub mod second_order;
pub mod study;
pub mod wire;

pub use case::document::CaseDocument;
pub use case::material::{MaterialDocument, MaterialDocuments};
pub use code::ErrorCode;
pub use cohort::document::CohortDocument;
pub use compare::document::CompareDocument;
pub use meshing::MeshingDocument;
pub use optimise::document::OptimiseDocument;
pub use plan::document::PlanDocument;
pub use predict::document::PredictDocument;
pub use reproduce::document::ReproduceDocument;
pub use response::ResponseDocument;
pub use study::document::StudyDocument;
pub use study::report::ReportDocument;
pub use wire::fault::{Faults, FieldError, Pointer};
pub use wire::limits::Limits;
pub use wire::problem::{Problem, ProblemDocument};
pub use wire::vector::{CornerPair, Matrix4x4, PartialTriple, Sphere, Triple};
pub use wire::warning::WarningDocument;
