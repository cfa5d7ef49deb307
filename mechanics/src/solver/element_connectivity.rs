//! Element connectivity: groups of rows that are coupled to each other, such as the nodes of cells.

use crate::rows::Rows;

/// The rows of each element.
pub type ElementConnectivity = Rows<u32>;

/// For each row the elements it belongs to, ascending: the inverse of the connectivity.
pub type ElementsOfRow = Rows<u32>;

/// The elements in another order, with rows renumbered.
pub fn renumbered(
    connectivity: &ElementConnectivity,
    order: &[u32],
    place: &[u32],
) -> ElementConnectivity {
    let mut renumbered = Rows::with_room(connectivity.len(), connectivity.entries().len());
    for &element in order {
        renumbered.push(connectivity.row(element as usize).iter().map(|&row| place[row as usize]));
    }
    renumbered
}
