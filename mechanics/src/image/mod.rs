//! What a scanner saw: a scalar image on a regular grid, and what it says about the cells of a mesh.

pub mod cells;
pub mod sampling;
pub mod volume;

pub use cells::{SampledCells, Windows, sample_cells};
pub use sampling::{MOST_SAMPLES, SamplingRule};
pub use volume::{ImageError, ImageVolume, Placement, Voxels};
