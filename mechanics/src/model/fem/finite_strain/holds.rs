//! What holds take of forces and of unknowns.

use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;

/// The part of a force along the directions in which a node is held.
pub(super) fn along_holds(hold: &Hold, force: &Vector) -> Vector {
    let own = hold.axes().transpose() * force;
    hold.axes() * Vector::from_fn(|k, _| if k < hold.count() { own[k] } else { 0.0 })
}

/// The number of unknowns that are not held.
pub(super) fn free_unknowns(constrained: &Constrained) -> usize {
    let partly = constrained.holds.iter().filter(|hold| hold.count() < 3);
    3 * constrained.numbering.layout.free - partly.map(Hold::count).sum::<usize>()
}
