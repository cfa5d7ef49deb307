//! Structures that must not be sawn: nerves and roots of teeth, as lines with a radius.

use crate::mesh::Vector;

/// A line that cuts have to keep clear of.
#[derive(Clone, Debug, PartialEq)]
pub struct Risk {
    pub name: String,
    /// Two or more, in mm.
    pub points: Vec<Vector>,
    /// Of a nerve or a root around its line, in mm.
    pub radius: f64,
    /// Cuts nearer than this are warned of, in mm.
    pub clearance: f64,
}
