//! Surgical plans: which bone segments move, and how.

pub mod doubt;
pub mod movement;
pub mod transform_text;

pub use movement::{MovementError, NUMBERS, Restriction, RigidMovement};

/// A segment by the name it has in the case, and its movement in the frame of the case.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedSegment {
    pub name: String,
    pub movement: RigidMovement,
}
