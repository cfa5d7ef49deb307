//! Stored meshes and responses, kept parsed in memory while there is room.

pub mod applied;
pub mod cache;
pub mod loaded_response;
pub mod mesh_report;
pub mod meshes;
pub mod pictures;
pub mod responses;
pub mod upload;
