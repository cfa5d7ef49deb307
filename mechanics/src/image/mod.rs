//! Medical images: a scalar image on a regular grid, its values in the cells of a mesh, and its segmentation.

pub mod cells;
pub mod coarsened;
pub mod distance;
pub mod equal_volume;
pub mod holes;
pub mod labels;
pub(crate) mod lines;
pub mod mask;
pub mod morphology;
pub mod outer_skin;
pub mod pieces;
pub mod reduction;
pub mod sampling;
pub mod scan_report;
pub mod separation;
pub(crate) mod smoothing;
pub mod spline;
pub mod spline_ranges;
pub mod thresholds;
pub mod volume;

pub use cells::{SampledCells, Windows, sample_cells};
pub use labels::LabelMap;
pub use mask::{Grid, Mask};
pub use outer_skin::{OuterSkin, outer_skin};
pub use pieces::{Connection, Pieces};
pub use sampling::{MOST_SAMPLES, SamplingRule};
pub use scan_report::{ScanReport, scan_report};
pub use spline::{CubicSpline, SplineValue};
pub use spline_ranges::{Range, SplineRanges};
pub use thresholds::{Histogram, Thresholds};
pub use volume::{ImageError, ImageVolume, Placement, Voxels};
