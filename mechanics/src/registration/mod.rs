//! Registration of one shape onto another: rigid movement from pairs of points, and iterative closest point.

pub mod closest_point;
mod masked_points;
pub mod mirror;
pub mod performed;
mod rigid;
mod sphere_or_box;
mod start;
pub mod thin_plate_spline;
mod uncertainty;

pub use closest_point::{IterativeClosestPoint, SurfaceAlignment};
pub use rigid::{PointAlignment, RigidTransform, align_points, align_weighted_points};
pub use sphere_or_box::SphereOrBox;
pub use start::Start;
pub use thin_plate_spline::ThinPlateSpline;
pub use uncertainty::{RigidUncertainty, StandardError, undetermined};

use crate::mesh::SearchError;

/// Why one shape cannot be brought onto another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AlignmentError {
    #[error("{from} points are to be moved onto {to}: they have to come in pairs")]
    NotPaired { from: usize, to: usize },
    #[error("{points} pairs of points do not determine a rigid movement, 3 are needed")]
    TooFewPoints { points: usize },
    #[error(
        "the points lie on a line or nearly so: they are {width:.3e} mm wide and {length:.3e} mm long"
    )]
    Collinear { width: f64, length: f64 },
    #[error(
        "the points do not determine a rotation: their second correlation is {ratio:.1e} of the first"
    )]
    Ambiguous { ratio: f64 },
    #[error(
        "pair {pair} has a coordinate or a weight that is not a finite number, or a negative weight"
    )]
    NotFinite { pair: usize },
    #[error("{points} landmarks do not determine a map of space, {needed} are needed")]
    FewLandmarks { points: usize, needed: usize },
    #[error(
        "the landmarks lie in a plane or nearly so: they are {thickness:.3e} mm thick and {length:.3e} mm long"
    )]
    Coplanar { thickness: f64, length: f64 },
    #[error("landmarks {one} and {other} (from 0) are at one place, or {distance:.1e} mm apart")]
    SamePlace { one: usize, other: usize, distance: f64 },
    #[error("no part of the fixed surface lies in the mask")]
    EmptyMask,
    #[error("only {pairs} of {points} points of the fixed surface lie opposite the moving one")]
    NoOverlap { pairs: usize, points: usize },
    #[error(
        "the mean squared distance still changes by {change:.1e} of itself after {iterations} iterations, wanted {wanted:.1e}"
    )]
    NotConverged { iterations: usize, change: f64, wanted: f64 },
    #[error("a surface cannot be searched: {0}")]
    Surface(#[from] SearchError),
    #[error("cancelled after {iterations} iterations of the alignment")]
    Cancelled { iterations: usize },
}
