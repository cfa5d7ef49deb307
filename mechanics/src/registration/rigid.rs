//! The rigid movement that brings pairs of points together in the sense of least squares.
//!
//! min over R, t of Σ w_i |R a_i + t - b_i|²,   H = Σ w_i (a_i - ā)(b_i - b̄)ᵀ = U S Vᵀ
//! R = V diag(1, 1, d) Uᵀ,  d = det(V Uᵀ),  t = b̄ - R ā
//!
//! Source: Kabsch, Acta Crystallographica A32 (1976) 922; the sign d is from Umeyama, IEEE
//! Transactions on Pattern Analysis and Machine Intelligence 13 (1991) 376, lemma. With -d in its
//! place the same formula gives the best mirror image, reported beside it and never used.

use nalgebra::Matrix3;

use super::AlignmentError;
use crate::mesh::Vector;

/// Points whose width is below this share of their length count as lying on a line.
const SMALLEST_WIDTH: f64 = 1e-6;

/// Below this share of the first, the second singular value of H is rounding.
const SMALLEST_CORRELATION: f64 = 1e-13;

/// x' = R x + t: a rotation with determinant +1 and a translation in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    pub rotation: Matrix3<f64>,
    pub translation: Vector,
}

impl RigidTransform {
    pub fn identity() -> Self {
        RigidTransform { rotation: Matrix3::identity(), translation: Vector::zeros() }
    }

    /// A rotation about `centre`, then a translation.
    pub fn about(centre: &Vector, rotation: Matrix3<f64>, translation: Vector) -> Self {
        RigidTransform { rotation, translation: centre - rotation * centre + translation }
    }

    pub fn apply(&self, point: &Vector) -> Vector {
        self.rotation * point + self.translation
    }

    /// This transform first, then `next`.
    pub fn then(&self, next: &RigidTransform) -> RigidTransform {
        RigidTransform {
            rotation: next.rotation * self.rotation,
            translation: next.rotation * self.translation + next.translation,
        }
    }

    pub fn inverse(&self) -> RigidTransform {
        let rotation = self.rotation.transpose();
        RigidTransform { rotation, translation: -(rotation * self.translation) }
    }

    /// The angle of the rotation in radians, in [0, π].
    pub fn angle(&self) -> f64 {
        let r = &self.rotation;
        let twice_sine =
            Vector::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
        twice_sine.norm().atan2(r.trace() - 1.0)
    }

    /// Of a row-major matrix that is known to be rigid.
    pub fn from_matrix4(entries: &[f64; 16]) -> Self {
        RigidTransform {
            rotation: Matrix3::from_fn(|row, column| entries[4 * row + column]),
            translation: Vector::new(entries[3], entries[7], entries[11]),
        }
    }

    /// Row-major, with last row 0 0 0 1.
    pub fn matrix4(&self) -> [f64; 16] {
        let (r, t) = (&self.rotation, &self.translation);
        std::array::from_fn(|place| match (place / 4, place % 4) {
            (3, column) => f64::from(u8::from(column == 3)),
            (row, 3) => t[row],
            (row, column) => r[(row, column)],
        })
    }
}

/// The best rigid transform of some pairs of points, and how well it brings them together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointAlignment {
    pub transform: RigidTransform,
    /// Root of the weighted mean squared distance that is left, in mm.
    pub rms: f64,
    /// What would be left if the points were mirrored as well, in mm. Much less than `rms` where one
    /// set is the mirror image of the other.
    pub mirrored_rms: f64,
}

/// Moves `from` onto `to`, every pair counting the same. Three pairs that are not on a line are needed.
pub fn align_points(from: &[Vector], to: &[Vector]) -> Result<PointAlignment, AlignmentError> {
    align_weighted_points(from, to, &vec![1.0; from.len()])
}

/// Moves `from` onto `to`, each pair with its weight of zero or more.
pub fn align_weighted_points(
    from: &[Vector],
    to: &[Vector],
    weights: &[f64],
) -> Result<PointAlignment, AlignmentError> {
    check(from, to, weights)?;
    let centres = [centre_of(from, weights), centre_of(to, weights)];
    for (points, centre) in [(from, &centres[0]), (to, &centres[1])] {
        refuse_lines(points, centre, weights)?;
    }
    let mut correlation = Matrix3::zeros();
    for ((a, b), &weight) in from.iter().zip(to).zip(weights) {
        correlation += (a - centres[0]) * (b - centres[1]).transpose() * weight;
    }
    let decomposition = correlation.svd(true, true);
    let [first, second] = [0, 1].map(|i| decomposition.singular_values[i]);
    let ratio = second / first;
    let (Some(u), Some(v_t)) = (decomposition.u, decomposition.v_t) else {
        return Err(AlignmentError::Ambiguous { ratio });
    };
    if ratio.is_nan() || ratio < SMALLEST_CORRELATION {
        return Err(AlignmentError::Ambiguous { ratio });
    }
    let (u_t, v) = (u.transpose(), v_t.transpose());
    let sign = (v * u_t).determinant().signum();
    let rotation = |last: f64| v * Matrix3::from_diagonal(&Vector::new(1.0, 1.0, last)) * u_t;
    let moved_by = |rotation: Matrix3<f64>| RigidTransform {
        rotation,
        translation: centres[1] - rotation * centres[0],
    };
    let rms = |transform: &RigidTransform| {
        let mut sum = 0.0;
        for ((a, b), &weight) in from.iter().zip(to).zip(weights) {
            // About the centres, so that a far origin costs no digits.
            let moved = transform.rotation * (a - centres[0]);
            sum += weight * (moved - (b - centres[1])).norm_squared();
        }
        (sum / weights.iter().sum::<f64>()).sqrt()
    };
    let transform = moved_by(rotation(sign));
    let mirrored_rms = rms(&moved_by(rotation(-sign)));
    Ok(PointAlignment { transform, rms: rms(&transform), mirrored_rms })
}

fn check(from: &[Vector], to: &[Vector], weights: &[f64]) -> Result<(), AlignmentError> {
    if from.len() != to.len() || from.len() != weights.len() {
        return Err(AlignmentError::NotPaired { from: from.len(), to: to.len() });
    }
    // Squares of larger numbers would overflow.
    let is_bad = |x: &f64| x.is_nan() || x.abs() >= 1e100;
    for pair in 0..from.len() {
        let coordinates = from[pair].iter().chain(to[pair].iter());
        if coordinates.chain([&weights[pair]]).any(is_bad) || weights[pair] < 0.0 {
            return Err(AlignmentError::NotFinite { pair });
        }
    }
    let points = weights.iter().filter(|&&weight| weight > 0.0).count();
    if points < 3 {
        return Err(AlignmentError::TooFewPoints { points });
    }
    Ok(())
}

fn centre_of(points: &[Vector], weights: &[f64]) -> Vector {
    let total: f64 = weights.iter().sum();
    // Relative to the first point, so that points far from the origin keep their digits.
    let offsets = points.iter().zip(weights).map(|(point, &weight)| (point - points[0]) * weight);
    points[0] + offsets.sum::<Vector>() / total
}

/// Length and width are the roots of the two largest second moments.
fn refuse_lines(points: &[Vector], centre: &Vector, weights: &[f64]) -> Result<(), AlignmentError> {
    let root_weight = |weight: f64| weight.sqrt();
    let mut offsets = nalgebra::Matrix3xX::zeros(points.len());
    for (column, (point, &weight)) in points.iter().zip(weights).enumerate() {
        offsets.set_column(column, &((point - centre) * root_weight(weight)));
    }
    // Of the offsets and not of their squares, in which a narrow width would drown.
    let spreads = offsets.singular_values();
    let total: f64 = weights.iter().sum();
    let [length, width] = [0, 1].map(|i| spreads[i] / total.sqrt());
    if width <= SMALLEST_WIDTH * length {
        return Err(AlignmentError::Collinear { width, length });
    }
    Ok(())
}
