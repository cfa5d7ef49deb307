//! Meshing: the job that makes a volume mesh from a scan, and what it says of the mesh.

pub mod document;
pub mod result;

pub use document::MeshingDocument;
