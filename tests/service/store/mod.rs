//! Rows and bytes, on both engines.

pub mod made;
pub mod queue;
pub mod races;
pub mod remembered;
pub mod schema_steps;
pub mod storage;
pub mod transfer;
