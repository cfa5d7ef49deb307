//! Rigid movement of a bone segment before meshing.

use crate::registration::RigidTransform;

/// A segment by its number, and where it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    pub segment: usize,
    pub movement: RigidTransform,
}
