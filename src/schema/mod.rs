//! The JSON documents of the service and the command line: units in the names, every value checked,
//! converted once to and from the types of the path (mm, ms, mg, mN, kPa, radians).

pub mod canonical;
pub mod case;
pub mod case_conversion;
pub mod check;
pub mod compare;
pub mod fault;
pub mod job;
pub mod limits;
pub mod load;
pub mod material;
pub mod mesh;
pub mod methods;
pub mod movement;
pub mod optimisation;
pub mod optimise;
pub mod plan;
pub mod prediction;
pub mod problem;
pub mod report;
pub mod response;
pub mod selection;
pub mod spec;
pub mod strict;
pub mod study;
mod study_check;
mod text_or_object;
pub mod validation;
pub mod vector;
pub mod warning;

pub use case::CaseDocument;
pub use compare::CompareDocument;
pub use fault::{Faults, FieldError, Pointer};
pub use limits::Limits;
pub use material::{MaterialDocument, MaterialDocuments};
pub use optimise::OptimiseDocument;
pub use plan::PlanDocument;
pub use problem::{Problem, ProblemDocument};
pub use report::ReportDocument;
pub use response::ResponseDocument;
pub use spec::PredictDocument;
pub use study::StudyDocument;
pub use vector::{CornerPair, Matrix4x4, PartialTriple, Sphere, Triple};
pub use warning::WarningDocument;
