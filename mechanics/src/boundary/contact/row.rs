//! One inequality of contact: a node and the point of the boundary that it may not pass.

use crate::mesh::Vector;

/// g(u) = gap + sum c_a . u_a >= 0, with a pressing force along c_a at each node a (Signorini 1959; node to surface).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRow {
    /// The node that is kept from passing.
    pub node: u32,
    /// The node with the unit normal n, and the corners of the triangle that it faces with -w n, w their weights.
    pub terms: Vec<(u32, Vector)>,
    /// At rest, in mm; nothing may be below 0 there.
    pub gap: f64,
}

impl ContactRow {
    /// g after a displacement, in mm.
    pub fn gap_after(&self, displacement: &[Vector]) -> f64 {
        let moved = self.terms.iter().map(|(node, along)| along.dot(&displacement[*node as usize]));
        self.gap + moved.sum::<f64>()
    }
}
