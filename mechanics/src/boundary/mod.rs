//! Boundary conditions of the nodes of a mesh, from case and plan.

pub mod carried;
pub mod conditions;
pub mod contact;
pub mod freedom;
pub mod hold;
pub mod midpoint;
pub mod selection;
pub mod sliding;
pub mod support;
pub mod tearing;

pub use carried::{ConnectedPart, Form, HeldRows, Holder, RigidPart, connected_parts};
pub use conditions::{ConditionError, Conditions, HeldNodes, NodeClass, Wall, WallNode};
pub use freedom::Freedom;
pub use hold::Hold;
pub use selection::{NodeSelection, SelectionError, Selector};
