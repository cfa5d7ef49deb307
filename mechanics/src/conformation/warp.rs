//! Smooth maps from a template to a patient, and what they do to lines that lie in the tissue.

use nalgebra::Matrix3;

use super::deformation::Deformation;
use super::error::ConformationError;
use super::landmark::Landmark;
use crate::mesh::Vector;
use crate::registration::{AlignmentError, ThinPlateSpline};

/// A map of space in mm with its gradient.
pub trait Warp: Sync {
    fn apply(&self, point: &Vector) -> Vector;

    /// F = ∂f/∂x.
    fn gradient(&self, point: &Vector) -> Matrix3<f64>;

    /// The direction of a line of the template after the map, F a, as long as it was; nothing for a vector without length,
    /// or where the map leaves none.
    fn along(&self, point: &Vector, direction: &Vector) -> Option<Vector> {
        let moved = self.gradient(point) * direction;
        let (before, after) = (direction.norm(), moved.norm());
        (before > 0.0 && after > 0.0 && after.is_finite()).then(|| moved * (before / after))
    }
}

impl Warp for Deformation {
    fn apply(&self, point: &Vector) -> Vector {
        Deformation::apply(self, point)
    }

    fn gradient(&self, point: &Vector) -> Matrix3<f64> {
        Deformation::gradient(self, point)
    }
}

impl Warp for ThinPlateSpline {
    fn apply(&self, point: &Vector) -> Vector {
        ThinPlateSpline::apply(self, point)
    }

    fn gradient(&self, point: &Vector) -> Matrix3<f64> {
        ThinPlateSpline::gradient(self, point)
    }
}

/// The thin-plate spline that meets every landmark: the map by which Kim et al. 2012, section 3.1, bring the muscles of a
/// template to a patient, with 32 of them.
pub fn spline_of(landmarks: &[Landmark]) -> Result<ThinPlateSpline, ConformationError> {
    let from: Vec<Vector> = landmarks.iter().map(|one| one.template).collect();
    let to: Vec<Vector> = landmarks.iter().map(|one| one.patient).collect();
    ThinPlateSpline::new(&from, &to, 0.0).map_err(|error| match error {
        AlignmentError::SamePlace { one, other, .. } => {
            let [one, other] = [one, other].map(|number| landmarks[number].name.clone());
            ConformationError::SameLandmark { one, other }
        }
        other => ConformationError::Spline(other),
    })
}
