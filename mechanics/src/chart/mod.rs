//! Pictures without a GPU: surfaces drawn in software inside an SVG whose words stay words.
//!
//! Knows nothing of meshes or jobs: it takes points, triangles, values and names.

mod axis;
mod callout;
mod classes;
pub mod colour;
mod displacement;
mod facet;
mod ladder;
mod ladder_legend;
mod legend;
pub mod raster;
mod slices;
mod stability_map;
mod svg;
mod symbol;
pub mod view;

pub use classes::{ClassKind, ClassesPicture, NodeClasses};
pub use displacement::DisplacementPicture;
pub use ladder::{LadderFailure, LadderMark, LadderPicture};
pub use raster::{Image, PngError};
pub use slices::SlicesPicture;
pub use stability_map::{Mark, StabilityAxis, StabilityMap};
pub use view::{Outlook, clear_front, front_of};

/// A position in mm.
type Vector = nalgebra::Vector3<f64>;
