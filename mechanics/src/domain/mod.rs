//! The body to be meshed as an implicit function: tissue where it is positive.
//!
//! A mesher asks for signs at the nodes of a lattice, for the places where lattice edges cross a boundary, and for the
//! nearest point of a boundary. Everything else about scans and surfaces stays on this side.

mod airway_map;
pub mod assessment;
mod bone_depths;
mod channels;
mod closed;
mod compartments;
mod containment;
mod cut_ends;
mod dipoles;
mod facets;
mod flood;
mod hollows;
pub mod image;
pub mod image_error;
mod image_options;
mod label_body;
mod left_out;
mod lids;
pub mod limit;
pub mod mending;
mod nearest_boundary;
mod node_stack;
mod overlaps;
mod region_map;
mod root;
mod scanned_skin;
mod second_sheets;
mod shell;
mod smoothed;
pub mod surface;
pub mod surface_error;
mod thickness;
mod triangle;
mod triangle_tree;
mod winding_cells;

pub use assessment::Assessment;
pub use bone_depths::BoneDepths;
pub use closed::ClosedSurface;
pub use containment::Containment;
pub use hollows::Hollow;
pub use image::ImageDomain;
pub use image_error::ImageDomainError;
pub use image_options::ImageOptions;
pub use label_body::{LabelBody, LabelClass};
pub use left_out::LeftOut;
pub use limit::{Ball, Limit, LimitError, Limits};
pub use mending::Mending;
pub use overlaps::Overlap;
pub use scanned_skin::ScannedSkin;
pub use surface::SurfaceDomain;
pub use surface_error::{SurfaceDomainError, SurfaceName};

use crate::mesh::Vector;

/// Boundary of the tissue at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Boundary {
    /// The outer, visible surface.
    Skin,
    /// Air inside the head: nose, mouth, throat.
    Airway,
    /// Bone, teeth included.
    Bone,
    /// Where the scan or the region of interest ends.
    Cut,
}

/// Content of a ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Tissue alone.
    Inside,
    /// No tissue.
    Outside,
    /// Perhaps both.
    Mixed,
}

/// Where a segment of different signs meets the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// On the segment, in mm.
    pub point: Vector,
    pub boundary: Boundary,
}

/// A body given by the sign of a function. Lengths in mm; every method is pure, so that a mesh has the same bytes on any
/// number of threads.
pub trait Domain: Sync {
    /// The lowest and the highest corner of a box that holds all tissue.
    fn bounds(&self) -> (Vector, Vector);

    /// What the ball of that radius holds; `Mixed` where that is not known for certain.
    fn coverage(&self, centre: &Vector, radius: f64) -> Coverage;

    /// Positive in tissue, negative or zero outside, finite everywhere; only its sign and its roots mean anything.
    fn value(&self, point: &Vector) -> f64;

    /// Where the segment between two points of different signs meets the boundary.
    fn crossing(&self, inside: &Vector, outside: &Vector) -> Crossing;

    /// The nearest point of that boundary, or `point` itself where none is near enough to be found.
    fn projection(&self, point: &Vector, boundary: Boundary) -> Vector;

    /// How thick the tissue is about a place; infinite where that is not known.
    fn thickness(&self, point: &Vector) -> f64;

    /// The same where it is below a limit in mm, and anything not below it elsewhere, which takes less.
    fn thickness_below(&self, point: &Vector, _limit: f64) -> f64 {
        self.thickness(point)
    }

    /// How many regions tissue is in, at most 255.
    fn regions(&self) -> usize {
        1
    }

    /// The region of a place in tissue, from 0.
    fn region(&self, _point: &Vector) -> u8 {
        0
    }

    /// The place on the way from one point to another, of two regions, where that of the first ends; the middle where tissue is of
    /// one kind.
    fn meeting(&self, [one, other]: &[Vector; 2], _between: [u8; 2]) -> Vector {
        (one + other) * 0.5
    }

    /// A place near a point where two regions meet, or `point` itself where none is found.
    fn interface(&self, point: &Vector, _between: [u8; 2]) -> Vector {
        *point
    }
}
