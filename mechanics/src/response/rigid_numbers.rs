//! The six numbers of a rigid movement, along whose axes higher orders of a response are sampled.

use crate::mesh::Vector;
use crate::plan::RigidMovement;

/// Sampled directions for each segment: three translations in mm, three rotations about its centre in radians.
pub const SAMPLES: usize = 6;

/// The translation in mm of a centre, and the rotation vector in radians.
pub(super) fn rigid_numbers(movement: &RigidMovement, centre: &Vector) -> [f64; SAMPLES] {
    let t = movement.displacement(centre);
    let r = movement.rotation();
    let twice = Vector::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let angle = movement.angle();
    let sine = 0.5 * twice.norm();
    // Half a turn has no axis in R - R^T; its length still counts, along all three axes alike.
    let w = match sine > 1e-9 {
        true => twice * (0.5 * angle / sine),
        false => Vector::repeat(angle / 3_f64.sqrt()),
    };
    [t.x, t.y, t.z, w.x, w.y, w.z]
}
