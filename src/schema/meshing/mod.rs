//! Meshing: the job that makes a volume mesh from a scan, a label map or surfaces, and its report.

pub mod cuts;
pub mod document;
pub mod labels;
pub mod landmarks;
pub mod result;
pub mod size;
pub mod skin_scan;
pub mod surfaces;
pub mod thresholds;
pub mod whole_bone;

pub use document::MeshingDocument;
