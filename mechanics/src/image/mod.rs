//! What a scanner saw: a scalar image on a regular grid, and what it says about the cells of a mesh.

pub mod cells;
pub mod distance;
pub(crate) mod lines;
pub mod reduction;
pub mod sampling;
pub(crate) mod smoothing;
pub mod spline;
pub mod spline_ranges;
pub mod volume;

pub use cells::{SampledCells, Windows, sample_cells};
pub use sampling::{MOST_SAMPLES, SamplingRule};
pub use spline::{CubicSpline, SplineValue};
pub use spline_ranges::{Range, SplineRanges};
pub use volume::{ImageError, ImageVolume, Placement, Voxels};
