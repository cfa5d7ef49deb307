//! Pictures without a GPU: surfaces drawn in software inside an SVG whose words stay words.
//!
//! Knows nothing of meshes or jobs: it takes points, triangles, values and names.

mod axis;
mod boxes;
mod callout;
mod cell_sizes;
mod classes;
pub mod colour;
mod contour_grid;
mod contours;
mod displacement;
pub mod drawing;
mod estimates;
mod facet;
mod gaps;
pub mod helvetica;
mod histogram;
mod label_column;
mod ladder;
mod ladder_content;
mod ladder_failures;
mod ladder_layout;
mod ladder_legend;
mod learning;
mod legend;
mod muscles;
mod path_steps;
pub mod pdf;
pub mod raster;
mod series;
mod slices;
mod stability_map;
pub mod svg;
mod symbol;
pub mod view;
mod views;

pub use boxes::{BoxesGroup, BoxesPicture};
pub use cell_sizes::{CellSizesPicture, CellSizesSeries};
pub use classes::{ClassKind, ClassesPicture, NodeClasses};
pub use contour_grid::ContourAxis;
pub use contours::ContourPicture;
pub use displacement::DisplacementPicture;
pub use estimates::{EstimateMark, EstimatesPicture};
pub use gaps::{GapsOfBone, GapsPicture};
pub use histogram::HistogramPicture;
pub use ladder_content::{LadderFailure, LadderMark, LadderPicture};
pub use learning::{LearningPicture, LearningSeries};
pub use muscles::{MuscleGroup, MusclesPicture};
pub use raster::{Image, PngError};
pub use series::MethodSeries;
pub use slices::SlicesPicture;
pub use stability_map::{Mark, StabilityAxis, StabilityMap};
pub use view::{FaceDirection, clear_front, front_of};
pub use views::{ViewOutline, ViewRow, ViewValues, ViewsPicture};

/// A position in mm.
type Vector = nalgebra::Vector3<f64>;
