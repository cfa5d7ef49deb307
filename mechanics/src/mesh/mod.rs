//! Meshes: volume meshes of soft tissue and triangle surfaces, node positions in mm.

pub mod area_sampling;
pub mod ball;
pub mod bisection;
mod bounds;
mod cell_interior;
pub mod cell_overlap;
pub mod check;
pub mod closest_point;
pub mod clusters;
pub mod conformity;
pub mod connectivity;
pub mod crossing;
pub mod cubes;
pub mod disjoint_sets;
pub mod duplicate_cells;
pub mod enclosed;
mod face_shape;
pub mod frame;
pub mod generic_face;
pub mod half_head;
pub mod ignored;
pub mod jacobian;
mod missing_array;
pub mod orientation;
mod place;
pub mod quality;
pub mod refinement;
pub mod sample;
pub mod surface;
pub mod surface_edges;
mod surface_topology;
pub mod volume;
pub mod warning;
mod way_out;

pub use bounds::{EMPTY_BOUNDS, bounds_of, boxes_meet};
pub use closest_point::{ClosestPoint, SearchError, SurfaceSearch, TriangleSearch};
pub use frame::Frame;
pub use ignored::{ArrayUse, IgnoredArray, IgnoredArrays, ValuesOf};
pub use place::place;
pub use surface::TriangleSurface;
pub use volume::{CellShape, Cells, VolumeMesh};
pub use warning::Warning;

/// A position or a displacement in mm.
pub type Vector = nalgebra::Vector3<f64>;
