//! Refusals of surfaces that bound no tissue, each with its surface and its numbers.

use std::fmt;

use super::limit::LimitError;
use crate::mesh::{Vector, place};

/// Which of the surfaces of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceName {
    Skin,
    /// By its place among the bones, from 0.
    Bone(usize),
    /// By its place among the muscles, from 0.
    Muscle(usize),
}

impl fmt::Display for SurfaceName {
    /// "skin", "bone 1", "bone 2", "muscle 1", ...
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SurfaceName::Skin => formatter.write_str("skin"),
            SurfaceName::Bone(number) => write!(formatter, "bone {}", number + 1),
            SurfaceName::Muscle(number) => write!(formatter, "muscle {}", number + 1),
        }
    }
}

/// Why surfaces bound no tissue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceDomainError {
    #[error(
        "{surface}: point {point} has a coordinate {coordinate}; up to 1e6 mm from the origin are possible"
    )]
    Coordinate { surface: SurfaceName, point: usize, coordinate: f64 },
    #[error("{surface}: triangle {triangle} names point {point} of {points}")]
    Corner { surface: SurfaceName, triangle: usize, point: u32, points: usize },
    #[error("{surface}: none of {triangles} triangles has an area")]
    Empty { surface: SurfaceName, triangles: usize },
    #[error(
        "{surface}: {triangles} triangles with {open_edges} open edges enclose nothing: no winding number above 0.2; a surface has to go around what it bounds, with its triangles facing outwards: close its openings and turn the triangles that face inwards where it was made, or give the scan"
    )]
    NoInside { surface: SurfaceName, triangles: usize, open_edges: usize },
    #[error(
        "{surface}: the winding number inside is {level:.2} where a whole surface has 1: too much of it is missing or turned ({open_edges} open edges): close its openings, or turn the triangles that face inwards, where it was made"
    )]
    Incomplete { surface: SurfaceName, level: f64, open_edges: usize },
    #[error(
        "{surface}: {percent:.1} % of the inside is uncertain, with winding numbers that say neither in nor out ({open_edges} open edges, {pieces} pieces): close its openings and leave out pieces that are no part of it where it was made"
    )]
    Uncertain { surface: SurfaceName, percent: f64, open_edges: usize, pieces: usize },
    #[error(
        "{surface}: it has an opening as large as {percent:.0} % of its area ({open_edges} open edges): it was cut off there, and what is beyond is not known; close it where it was made"
    )]
    Open { surface: SurfaceName, percent: f64, open_edges: usize },
    #[error(
        "{surface}: {percent:.1} % of its inside lies between sheets that are there twice: which of them bounds the body is not known; give one of them alone"
    )]
    Doubled { surface: SurfaceName, percent: f64 },
    #[error(
        "{surface}: it has two walls, and {percent:.0} % of what it goes around lies within the inner one, outside of its body: give its outer wall alone"
    )]
    TwoWalls { surface: SurfaceName, percent: f64 },
    #[error(
        "{surface}: its triangles have {times:.0} times the area of its box; more than 20 times is no surface of a body: is it cut into many layers, or does the file hold several bodies? Give its outer surface alone"
    )]
    Tangled { surface: SurfaceName, times: f64 },
    #[error(
        "{surface}: {percent:.0} % of it lies outside the skin, the nearest of it {nearest:.0} mm from it: the skin reaches from {} to {} mm, this bone from {} to {}; are both in the same frame and unit?",
        place(&skin.0, 0), place(&skin.1, 0), place(&bone.0, 0), place(&bone.1, 0)
    )]
    BoneOutside {
        surface: SurfaceName,
        percent: f64,
        nearest: f64,
        /// The boxes of the skin and of this bone.
        skin: Box<(Vector, Vector)>,
        bone: Box<(Vector, Vector)>,
    },
    #[error(
        "{percent:.1} % of the inside of the skin is bone, which leaves no tissue{}",
        if *exchanged { "; bone reaches around the skin on all sides: were the two exchanged?" } else { "" }
    )]
    NoTissue { percent: f64, exchanged: bool },
    #[error(transparent)]
    Limit(#[from] LimitError),
}

impl SurfaceDomainError {
    /// The surface that it is about.
    pub fn surface(&self) -> Option<SurfaceName> {
        match self {
            SurfaceDomainError::Coordinate { surface, .. }
            | SurfaceDomainError::Corner { surface, .. }
            | SurfaceDomainError::Empty { surface, .. }
            | SurfaceDomainError::NoInside { surface, .. }
            | SurfaceDomainError::Incomplete { surface, .. }
            | SurfaceDomainError::Uncertain { surface, .. }
            | SurfaceDomainError::Open { surface, .. }
            | SurfaceDomainError::Doubled { surface, .. }
            | SurfaceDomainError::TwoWalls { surface, .. }
            | SurfaceDomainError::Tangled { surface, .. }
            | SurfaceDomainError::BoneOutside { surface, .. } => Some(*surface),
            SurfaceDomainError::NoTissue { .. } | SurfaceDomainError::Limit(_) => None,
        }
    }
}
