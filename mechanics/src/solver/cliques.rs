//! Groups of rows that are coupled to each other, such as the nodes of cells.

use crate::rows::Rows;

/// The members of each clique.
pub type Cliques = Rows<u32>;

/// For each row the cliques it is a member of, ascending: the inversion of cliques.
pub type CliquesOfRow = Rows<u32>;

/// The cliques in another order, with rows renumbered.
pub fn renumbered(cliques: &Cliques, order: &[u32], place: &[u32]) -> Cliques {
    let mut renumbered = Rows::with_room(cliques.len(), cliques.entries().len());
    for &clique in order {
        renumbered.push(cliques.row(clique as usize).iter().map(|&row| place[row as usize]));
    }
    renumbered
}
