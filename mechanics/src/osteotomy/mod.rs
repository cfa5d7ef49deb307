//! Osteotomies: cuts through bone, the segments between them, and the boundary conditions of the tissue around them.
//!
//! [`rule::Osteotomy`] says where is cut and what comes loose. [`labelling::label`] finds the segments in the bone of a
//! scan and [`label_surface`](label_surface::label_surface) makes closed surfaces of them;
//! [`surface_segment`](surface_segment::surface_segment) cuts them from a closed surface of bone. [`classes::classify`]
//! tells for each node of a mesh of the tissue with which of them it goes.

pub mod bone_image;
pub mod bone_labels;
mod cap;
pub mod classes;
pub mod clearance;
pub mod clip;
pub mod contact;
pub mod coverage;
pub mod cut;
pub mod cut_face;
mod flood;
mod free_band;
mod grid;
pub mod joining;
pub mod label_error;
pub mod label_surface;
pub mod labelling;
mod markers;
pub mod pieces;
pub mod risk;
pub mod rule;
pub mod surface_segment;
pub mod teeth;
pub mod voxel_cells;

pub use bone_image::BoneImage;
pub use bone_labels::{BoneLabels, Owner};
pub use cut::{Cut, CutError, Extent, Plane, Side};
pub use label_error::LabelError;
pub use labelling::{Labelled, label};
pub use risk::Risk;
pub use rule::{CutSide, Osteotomy, RuleError, SegmentRule};
