//! A segment of bone that is moved before anything is meshed.

use crate::registration::RigidTransform;

/// A segment by its number, and where it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    pub segment: usize,
    pub movement: RigidTransform,
}
