//! Thin-plate splines in space: the smoothest map that takes some landmarks to others.
//!
//! f(x) = b + A x + Σ w_i |x - x_i|,   Σ w_i = 0,   Σ w_i x_iᵀ = 0
//!
//! In three dimensions the kernel is the distance itself. It is conditionally negative
//! definite, so that the bending energy is -wᵀ K w and smoothing solves with K - λ I; K + λ I would raise
//! the energy. With four landmarks w is 0 and the map is affine.
//! Source: Duchon, Lecture Notes in Mathematics 571 (1977) 85; Bookstein, IEEE Transactions on Pattern
//! Analysis and Machine Intelligence 11 (1989) 567.

use nalgebra::{DMatrix, Matrix3, Matrix3xX};

use super::AlignmentError;
use crate::mesh::Vector;

/// Landmarks of fewer do not determine an affine map.
pub const FEWEST: usize = 4;

/// Landmarks that are thinner than this share of their length lie in a plane.
const SMALLEST_THICKNESS: f64 = 1e-6;

/// Landmarks that are nearer to each other than this share of the length of all are at one place.
const SMALLEST_DISTANCE: f64 = 1e-12;

/// A map of space, in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinPlateSpline {
    centres: Vec<Vector>,
    weights: Vec<Vector>,
    matrix: Matrix3<f64>,
    shift: Vector,
}

impl ThinPlateSpline {
    /// The spline that takes `from` to `to`, smoothed by λ = `smoothing` in mm; 0 meets every landmark.
    pub fn new(from: &[Vector], to: &[Vector], smoothing: f64) -> Result<Self, AlignmentError> {
        check(from, to)?;
        if smoothing == 0.0 {
            require_distance(from)?;
        }
        let count = from.len();
        // Relative to one of them, so that points far from the origin keep their digits.
        let origin = from[0];
        let local: Vec<Vector> = from.iter().map(|point| point - origin).collect();
        let mut matrix = DMatrix::zeros(count + 4, count + 4);
        let mut right = DMatrix::zeros(count + 4, 3);
        for (row, at) in local.iter().enumerate() {
            for (column, other) in local.iter().enumerate() {
                matrix[(row, column)] = (at - other).norm();
            }
            matrix[(row, row)] -= smoothing;
            let polynomial = [1.0, at.x, at.y, at.z];
            for (place, value) in polynomial.into_iter().enumerate() {
                matrix[(row, count + place)] = value;
                matrix[(count + place, row)] = value;
            }
            for axis in 0..3 {
                right[(row, axis)] = to[row][axis];
            }
        }
        let singular = AlignmentError::Coplanar { thickness: 0.0, length: 0.0 };
        let solution = matrix.full_piv_lu().solve(&right).ok_or(singular)?;
        let row = |row: usize| Vector::from_fn(|axis, _| solution[(row, axis)]);
        let matrix = Matrix3::from_fn(|axis, column| solution[(count + 1 + column, axis)]);
        let weights = (0..count).map(row).collect();
        let shift = row(count) - matrix * origin;
        Ok(ThinPlateSpline { centres: from.to_vec(), weights, matrix, shift })
    }

    pub fn apply(&self, point: &Vector) -> Vector {
        let bent = self.centres.iter().zip(&self.weights);
        let bent: Vector = bent.map(|(centre, weight)| weight * (point - centre).norm()).sum();
        self.shift + self.matrix * point + bent
    }

    /// ∂f/∂x = A + Σ w_i (x - x_i)ᵀ / |x - x_i|. At a landmark itself its own part has no direction and is left out.
    pub fn gradient(&self, point: &Vector) -> Matrix3<f64> {
        let mut gradient = self.matrix;
        for (centre, weight) in self.centres.iter().zip(&self.weights) {
            let offset = point - centre;
            let distance = offset.norm();
            if distance > 0.0 {
                gradient += weight * offset.transpose() / distance;
            }
        }
        gradient
    }

    /// The w of each landmark; 0 where the map is affine.
    pub fn weights(&self) -> &[Vector] {
        &self.weights
    }

    /// -wᵀ K w over the three coordinates: 0 where the map is affine.
    pub fn bending_energy(&self) -> f64 {
        let mut energy = 0.0;
        for (one, own) in self.centres.iter().zip(&self.weights) {
            for (other, theirs) in self.centres.iter().zip(&self.weights) {
                energy -= own.dot(theirs) * (one - other).norm();
            }
        }
        energy
    }
}

fn check(from: &[Vector], to: &[Vector]) -> Result<(), AlignmentError> {
    if from.len() != to.len() {
        return Err(AlignmentError::NotPaired { from: from.len(), to: to.len() });
    }
    let is_bad = |point: &Vector| point.iter().any(|x| x.is_nan() || x.abs() >= 1e100);
    if let Some(pair) = from.iter().zip(to).position(|(a, b)| is_bad(a) || is_bad(b)) {
        return Err(AlignmentError::NotFinite { pair });
    }
    if from.len() < FEWEST {
        return Err(AlignmentError::FewLandmarks { points: from.len(), needed: FEWEST });
    }
    require_thickness(from, SMALLEST_THICKNESS)
}

/// Refuses two points at one place: no map meets both.
fn require_distance(points: &[Vector]) -> Result<(), AlignmentError> {
    let length = points.iter().map(|point| (point - points[0]).norm()).fold(0.0, f64::max);
    for (other, point) in points.iter().enumerate() {
        let distances = points[..other].iter().map(|earlier| (point - earlier).norm());
        for (one, distance) in distances.enumerate() {
            if distance <= SMALLEST_DISTANCE * length {
                return Err(AlignmentError::SamePlace { one, other, distance });
            }
        }
    }
    Ok(())
}

/// Refuses points that are thinner than a share of their length: they lie in a plane, or too nearly so for what is wanted of
/// them. Both are the roots of the mean squared distances from their middle along the principal axes.
pub fn require_thickness(points: &[Vector], share: f64) -> Result<(), AlignmentError> {
    let mut offsets = Matrix3xX::zeros(points.len());
    let middle = points.iter().sum::<Vector>() / points.len() as f64;
    for (column, point) in points.iter().enumerate() {
        offsets.set_column(column, &(point - middle));
    }
    let spreads = offsets.singular_values() / (points.len() as f64).sqrt();
    let (length, thickness) = (spreads[0], spreads[2]);
    if thickness <= share * length {
        return Err(AlignmentError::Coplanar { thickness, length });
    }
    Ok(())
}
