//! Holds and forces as the unknowns of a linear system: what is held, what is known, what acts, in the
//! frames of the holds, and back.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use crate::boundary::Hold;
use crate::mesh::Vector;

/// Nodes of which some are held, each along the first axes of a frame of its own.
pub struct Constrained<'a> {
    pub holds: &'a [Hold],
    pub nodes: usize,
}

impl Constrained<'_> {
    /// True for unknowns along held axes, and for nodes of no cell, which nothing couples.
    pub fn held_unknowns<'c>(&self, cells: impl Iterator<Item = &'c [u32]>) -> Vec<bool> {
        let mut held = vec![true; 3 * self.nodes];
        for &node in cells.flatten() {
            held[3 * node as usize..3 * node as usize + 3].fill(false);
        }
        for hold in self.holds {
            let first = 3 * hold.node as usize;
            held[first..first + hold.count()].fill(true);
        }
        held
    }

    /// The frames of nodes whose axes are not those of the coordinates.
    pub fn own_axes(&self) -> BTreeMap<usize, Matrix3<f64>> {
        let turned = self.holds.iter().filter(|hold| !hold.is_aligned());
        turned.map(|hold| (hold.node as usize, *hold.axes())).collect()
    }

    /// Displacement in mm along held axes, given for each hold; zero along free ones.
    pub fn known_displacement(&self, values: &[Vector]) -> Vec<f64> {
        let mut known = vec![0.0; 3 * self.nodes];
        for (hold, values) in self.holds.iter().zip(values) {
            let first = 3 * hold.node as usize;
            known[first..first + hold.count()].copy_from_slice(&values.as_slice()[..hold.count()]);
        }
        known
    }

    /// Nodal forces with those of turned nodes in their frames.
    pub fn acting_forces(&self, forces: &[Vector]) -> Vec<f64> {
        let mut acting: Vec<f64> = forces.iter().flat_map(|f| [f.x, f.y, f.z]).collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let local = hold.axes().transpose() * forces[hold.node as usize];
            let first = 3 * hold.node as usize;
            acting[first..first + 3].copy_from_slice(local.as_slice());
        }
        acting
    }

    /// What each hold exerts: the internal force less the acting one along its held axes, in the frame of
    /// the coordinates.
    pub fn reactions(&self, internal: &[f64], acting: &[f64]) -> Vec<Vector> {
        let reaction = |hold: &Hold| {
            let first = 3 * hold.node as usize;
            let local = Vector::from_fn(|k, _| match k < hold.count() {
                true => internal[first + k] - acting[first + k],
                false => 0.0,
            });
            hold.axes() * local
        };
        self.holds.iter().map(reaction).collect()
    }

    /// Nodal vectors in the frame of the coordinates.
    pub fn to_coordinates(&self, local: &[f64]) -> Vec<Vector> {
        let mut vectors: Vec<Vector> =
            local.chunks_exact(3).map(Vector::from_column_slice).collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let local = vectors[hold.node as usize];
            vectors[hold.node as usize] = hold.axes() * local;
        }
        vectors
    }
}
