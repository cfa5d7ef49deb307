//! From a plan and a mesh to what every node is held to.

pub mod conditions;
pub mod hold;
pub mod midpoint;
pub mod selection;
pub mod sliding;
pub mod support;
pub mod tearing;

pub use conditions::{ConditionError, Conditions, HeldNodes, NodeClass, Wall, WallNode};
pub use hold::Hold;
pub use selection::{NodeSelection, SelectionError, Selector};
