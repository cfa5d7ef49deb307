//! Boundary conditions of the nodes of a mesh, from case and plan.

pub mod carried;
pub mod conditions;
pub mod constraint;
pub mod contact;
pub mod freedom;
pub mod midpoint;
pub mod selection;
pub mod sliding;
pub mod support;
pub mod tearing;

pub use carried::{ConnectedPart, Form, HeldRows, RigidPart, connected_parts};
pub use conditions::{ConditionError, Conditions, HeldNodes, NodeClass, Wall, WallNode};
pub use constraint::{Constraint, Holder};
pub use freedom::Freedom;
pub use selection::{NodeSelection, SelectionError, Selector};
