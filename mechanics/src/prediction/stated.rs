//! Boundary conditions as case and plan state them, each with its place.

use crate::mesh::Vector;

/// A condition of the case or the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedCondition {
    /// JSON pointer, e.g. `/case/sliding/0`.
    pub pointer: String,
    /// The segment that moves it.
    pub segment: Option<u32>,
    /// The nodes that it names.
    pub nodes: Vec<u32>,
    pub constraints: StatedHold,
}

/// Components that a boundary condition constrains; of several at one node the first in this order prevails.
#[derive(Clone, Debug, PartialEq)]
pub enum StatedHold {
    /// Prescribed components.
    Components([bool; 3]),
    /// Nodes of a segment.
    Joined,
    Fixed,
    /// Unit normals of the walls of each node.
    Walls(Vec<Vec<Vector>>),
}
