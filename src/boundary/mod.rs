//! From a plan and a mesh to what every node is held to.

pub mod selection;

pub use selection::NodeSelection;
