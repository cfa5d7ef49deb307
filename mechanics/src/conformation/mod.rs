//! Conformation of a template mesh to a patient's skin and bone.

mod affine;
mod carried;
mod conform;
mod covering;
mod deformation;
mod error;
mod fibres;
mod fit;
mod landmark;
mod lattice;
mod matching;
mod outlier;
mod pull;
mod schedule;
mod sheet;
mod start;
mod surfaces;
mod warp;

pub use affine::Affine;
pub use carried::carried;
pub use conform::{Conformation, conform, conform_on};
pub use covering::Covering;
pub use deformation::Deformation;
pub use error::{ConformationError, SheetName};
pub use fibres::{
    FibreDifference, MappedLines, angle_between, cell_axes, fibre_difference, mapped_lines,
    mapped_surface,
};
pub use landmark::Landmark;
pub use outlier::{DoubtfulLandmark, FEWEST_CHECKED};
pub use schedule::{LATTICES, finest_spacing};
pub use start::Start;
pub use surfaces::{Patient, Template};
pub use warp::{Warp, spline_of};
