//! Landmarks of a head by their names, and the directions that they give it.
//!
//! The Frankfort plane is the one nearest to both poria and both orbitalia in the sense of least squares, its normal n
//! upwards. Left is the mean of the differences of these pairs, which operations on the jaws do not move, without its part along n;
//! forwards is left x n. So nothing depends on how the head lies in the scanner. An angle between a line and the plane is
//! asin(d . n / |d|).

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::Matrix3;

use crate::mesh::{Frame, Vector};

/// Landmarks nearer to each other than this, in mm, have no direction.
pub(super) const SAME_PLACE: f64 = 1e-6;

/// Landmarks in mm by their names.
pub struct Landmarks<'a>(pub &'a BTreeMap<String, Vector>);

/// The directions of a head, each of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadAxes {
    pub up: Vector,
    pub left: Vector,
    pub forwards: Vector,
}

/// Why landmarks are doubted.
#[derive(Clone, Debug, PartialEq)]
pub struct SwappedSides {
    pub left: String,
    pub right: String,
    /// How far the left one lies to the right of the right one, in mm.
    pub by: f64,
}

impl fmt::Display for SwappedSides {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let SwappedSides { left, right, by } = self;
        write!(f, "landmark {left} lies {by:.1} mm to the right of {right}: are the sides swapped?")
    }
}

const PAIRS: [[&str; 2]; 3] = [["Po_L", "Po_R"], ["Or_L", "Or_R"], ["Go_L", "Go_R"]];

impl Landmarks<'_> {
    pub(super) fn at(&self, name: &str) -> Option<Vector> {
        self.0.get(name).copied()
    }

    pub(super) fn direction(&self, from: &str, to: &str) -> Option<Vector> {
        (self.at(to)? - self.at(from)?).try_normalize(SAME_PLACE)
    }

    pub(super) fn length(&self, from: &str, to: &str) -> Option<f64> {
        Some((self.at(to)? - self.at(from)?).norm())
    }

    /// At the middle one of three landmarks, in degrees.
    pub(super) fn angle(&self, one: &str, at: &str, other: &str) -> Option<f64> {
        let (a, b) = (self.direction(at, one)?, self.direction(at, other)?);
        Some(a.cross(&b).norm().atan2(a.dot(&b)).to_degrees())
    }

    pub(super) fn distance_from_line(&self, point: &str, from: &str, to: &str) -> Option<f64> {
        let along = self.direction(from, to)?;
        Some((self.at(point)? - self.at(from)?).cross(&along).norm())
    }

    /// Of the line between two places, in degrees; positive where the second is higher.
    pub(super) fn above_frankfort(&self, from: Vector, to: Vector) -> Option<f64> {
        let direction = (to - from).try_normalize(SAME_PLACE)?;
        Some(direction.dot(&self.head()?.up).clamp(-1.0, 1.0).asin().to_degrees())
    }

    /// The directions of the head; nothing where poria, orbitalia, N or Me are missing.
    pub fn head(&self) -> Option<HeadAxes> {
        let plane = [self.at("Po_L")?, self.at("Po_R")?, self.at("Or_L")?, self.at("Or_R")?];
        let middle = plane.iter().sum::<Vector>() / 4.0;
        let moments = plane.iter().map(|p| (p - middle) * (p - middle).transpose());
        let modes = moments.sum::<Matrix3<f64>>().symmetric_eigen();
        let normal = modes.eigenvectors.column(modes.eigenvalues.imin()).into_owned();
        let upwards = self.at("N")? - self.at("Me")?;
        let up = if normal.dot(&upwards) < 0.0 { -normal } else { normal };
        let [po_left, po_right, or_left, or_right] = plane;
        let across = (po_left - po_right) + (or_left - or_right);
        let left = (across - up * across.dot(&up)).try_normalize(SAME_PLACE)?;
        Some(HeadAxes { up, left, forwards: left.cross(&up) })
    }

    /// Pairs whose left one lies on the right, by the frame: x points to the left in LPS, to the right in RAS.
    pub fn swapped_sides(&self, frame: Frame) -> Vec<SwappedSides> {
        let sign = match frame {
            Frame::Lps => 1.0,
            Frame::Ras => -1.0,
            Frame::Unspecified => return Vec::new(),
        };
        let swapped = |[left, right]: &[&str; 2]| {
            let by = sign * (self.at(right)?.x - self.at(left)?.x);
            let (left, right) = ((*left).to_owned(), (*right).to_owned());
            (by > 0.0).then_some(SwappedSides { left, right, by })
        };
        PAIRS.iter().filter_map(swapped).collect()
    }
}
