//! Rigid movements x' = R x + t, right-handed and active (docs/methods.md#boundary-conditions).

use nalgebra::{Matrix3, Rotation3};

use crate::mesh::Vector;

/// Numbers of a movement that a displacement is linear in: the rows of R - I, each followed by its t.
pub const NUMBERS: usize = 12;

/// How far a matrix may be from a rotation before it is refused.
const RIGID_TOLERANCE: f64 = 1e-6;

/// A rotation R and a translation t in mm: x' = R x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMovement {
    rotation: Matrix3<f64>,
    translation: Vector,
}

/// Restriction of a movement: to a direction, or to the plane across one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Restriction {
    Axis(Vector),
    Plane(Vector),
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MovementError {
    #[error("the last row of the matrix is {0:?} and has to be 0 0 0 1")]
    LastRow([f64; 4]),
    #[error(
        "the matrix is not rigid: R^T R differs from the identity by {deviation:.3e}, at most 1e-6 is allowed"
    )]
    NotOrthonormal { deviation: f64 },
    #[error("the matrix mirrors: its determinant is {determinant:.6}, and has to be +1")]
    Mirrors { determinant: f64 },
}

impl Default for RigidMovement {
    fn default() -> Self {
        RigidMovement { rotation: Matrix3::identity(), translation: Vector::zeros() }
    }
}

impl RigidMovement {
    /// R = Rz Ry Rx about a pivot, then a translation: x' = R (x - p) + p + t. Angles in radians.
    pub fn about_pivot(angles_xyz: Vector, pivot: Vector, translation: Vector) -> Self {
        let rotation = rotation_about(2, angles_xyz.z)
            * rotation_about(1, angles_xyz.y)
            * rotation_about(0, angles_xyz.x);
        let translation = pivot - rotation * pivot + translation;
        RigidMovement { rotation, translation }
    }

    /// A rotation about a place, which then moves by a displacement in mm.
    pub(crate) fn about_centre(rotation: Matrix3<f64>, centre: &Vector, moved: Vector) -> Self {
        RigidMovement { rotation, translation: moved - (rotation - Matrix3::identity()) * centre }
    }

    /// A rotation, which has to be orthonormal with determinant +1 to 1e-6, and a translation.
    pub fn new(rotation: Matrix3<f64>, translation: Vector) -> Result<Self, MovementError> {
        let deviation = (rotation.transpose() * rotation - Matrix3::identity()).amax();
        if deviation.is_nan() || deviation > RIGID_TOLERANCE {
            return Err(MovementError::NotOrthonormal { deviation });
        }
        let determinant = rotation.determinant();
        if determinant < 0.0 {
            return Err(MovementError::Mirrors { determinant });
        }
        Ok(RigidMovement { rotation, translation })
    }

    /// A row-major 4x4 matrix with last row 0 0 0 1.
    pub fn from_matrix4(entries: &[f64; 16]) -> Result<Self, MovementError> {
        let last_row = [entries[12], entries[13], entries[14], entries[15]];
        if last_row != [0.0, 0.0, 0.0, 1.0] {
            return Err(MovementError::LastRow(last_row));
        }
        let rotation = Matrix3::from_fn(|row, column| entries[4 * row + column]);
        Self::new(rotation, Vector::new(entries[3], entries[7], entries[11]))
    }

    pub fn rotation(&self) -> &Matrix3<f64> {
        &self.rotation
    }

    /// What an axis or a plane leaves of a movement about `pivot`: the shift along it, and the turn about the axis or
    /// about the normal of the plane.
    pub fn restricted(&self, pivot: &Vector, to: Restriction) -> RigidMovement {
        let direction = match to {
            Restriction::Axis(direction) | Restriction::Plane(direction) => direction.normalize(),
        };
        let shift = self.displacement(pivot);
        let along = direction * shift.dot(&direction);
        let shift = match to {
            Restriction::Axis(_) => along,
            Restriction::Plane(_) => shift - along,
        };
        let turn = Rotation3::from_matrix_unchecked(self.rotation).scaled_axis();
        let turn = Rotation3::new(direction * turn.dot(&direction));
        RigidMovement::about_centre(*turn.matrix(), pivot, shift)
    }

    /// The displacement of the origin, in mm.
    pub fn translation(&self) -> Vector {
        self.translation
    }

    /// This movement first, then `next`; both in the same fixed frame.
    pub fn then(&self, next: &RigidMovement) -> RigidMovement {
        RigidMovement {
            rotation: next.rotation * self.rotation,
            translation: next.rotation * self.translation + next.translation,
        }
    }

    pub fn inverse(&self) -> RigidMovement {
        let rotation = self.rotation.transpose();
        RigidMovement { rotation, translation: -(rotation * self.translation) }
    }

    pub fn apply(&self, point: &Vector) -> Vector {
        self.rotation * point + self.translation
    }

    /// (R - I) x + t: exactly zero for the identity.
    pub fn displacement(&self, point: &Vector) -> Vector {
        (self.rotation - Matrix3::identity()) * point + self.translation
    }

    /// The angle of the rotation in radians, in [0, pi].
    pub fn angle(&self) -> f64 {
        let r = &self.rotation;
        let twice_sine =
            Vector::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
        twice_sine.norm().atan2(r.trace() - 1.0)
    }

    /// The same movement written in the other of LPS and RAS, which differ by the signs of x and y.
    pub fn between_lps_and_ras(&self) -> RigidMovement {
        let flip = Matrix3::from_diagonal(&Vector::new(-1.0, -1.0, 1.0));
        RigidMovement {
            rotation: flip * self.rotation * flip,
            translation: flip * self.translation,
        }
    }
}

/// The rotation about one coordinate axis; exactly the identity for the angle 0.
fn rotation_about(axis: usize, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rotation = Matrix3::identity();
    rotation[(next, next)] = cosine;
    rotation[(last, last)] = cosine;
    rotation[(next, last)] = -sine;
    rotation[(last, next)] = sine;
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> RigidMovement {
        let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
        RigidMovement::about_pivot(
            angles,
            Vector::new(3.0, 40.0, -50.0),
            Vector::new(1.5, -0.7, 5.0),
        )
    }

    #[test]
    fn a_movement_followed_by_its_inverse_is_the_identity() {
        let round_trip = sample().then(&sample().inverse());
        let point = Vector::new(12.0, -70.0, 33.0);
        assert!(round_trip.displacement(&point).norm() < 1e-12);
    }

    #[test]
    fn the_pivot_moves_by_the_translation_alone() {
        let displacement = sample().displacement(&Vector::new(3.0, 40.0, -50.0));
        assert!((displacement - Vector::new(1.5, -0.7, 5.0)).norm() < 1e-12);
    }

    #[test]
    fn rotations_are_right_handed_and_applied_x_first() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let movement = RigidMovement::about_pivot(
            Vector::new(quarter, quarter, 0.0),
            Vector::zeros(),
            Vector::zeros(),
        );
        // y turns to z about x, and z then turns to x about y.
        assert!((movement.apply(&Vector::y()) - Vector::x()).norm() < 1e-15);
    }

    #[test]
    fn the_angle_of_a_turn_is_recovered() {
        for degrees in [0.0, 1e-6, 30.0, 179.0] {
            let angles = Vector::new(0.0, f64::to_radians(degrees), 0.0);
            let movement = RigidMovement::about_pivot(angles, Vector::x(), Vector::zeros());
            assert!((movement.angle().to_degrees() - degrees).abs() < 1e-9, "{degrees}");
        }
    }

    #[test]
    fn scaled_and_mirrored_matrices_are_refused() {
        let scaled = Matrix3::identity() * 1.001;
        let mirrored = Matrix3::from_diagonal(&Vector::new(-1.0, 1.0, 1.0));
        let zero = Vector::zeros();
        assert!(matches!(
            RigidMovement::new(scaled, zero),
            Err(MovementError::NotOrthonormal { .. })
        ));
        assert!(matches!(RigidMovement::new(mirrored, zero), Err(MovementError::Mirrors { .. })));
    }

    #[test]
    fn a_restricted_movement_keeps_the_shift_and_the_turn_that_are_left_to_it() {
        let pivot = Vector::new(3.0, 40.0, -50.0);
        let direction = Vector::new(0.0, 3.0, 4.0);
        let unit = direction / 5.0;
        let along = sample().restricted(&pivot, Restriction::Axis(direction));
        let shift = along.displacement(&pivot);
        assert!((shift - unit * Vector::new(1.5, -0.7, 5.0).dot(&unit)).norm() < 1e-12);
        // What lies on the axis slides along it.
        assert!(along.displacement(&(pivot + unit * 30.0)).cross(&unit).norm() < 1e-12);
        let within = sample().restricted(&pivot, Restriction::Plane(direction));
        assert!(within.displacement(&pivot).dot(&unit).abs() < 1e-12);
        // And every point stays in its plane.
        assert!(within.displacement(&Vector::new(70.0, -9.0, 12.0)).dot(&unit).abs() < 1e-12);
        assert!(along.angle() > 0.01 && (along.angle() - within.angle()).abs() < 1e-12);
        // What moves so already is left as it is.
        let again = along.restricted(&pivot, Restriction::Axis(direction));
        assert!((again.rotation - along.rotation).amax() < 1e-12);
    }

    #[test]
    fn changing_between_lps_and_ras_flips_x_and_y() {
        let flip = |v: Vector| Vector::new(-v.x, -v.y, v.z);
        let point = Vector::new(12.0, -70.0, 33.0);
        let there = sample().between_lps_and_ras().apply(&flip(point));
        assert!((there - flip(sample().apply(&point))).norm() < 1e-12);
    }
}
