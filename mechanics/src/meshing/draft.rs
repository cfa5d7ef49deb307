//! Unfinished mesh: tetrahedra over nodes that know the boundaries they lie on.

use super::boundary_set::BoundarySet;
use super::shape::{determinant, worst_sine};
use crate::mesh::Vector;
use crate::rows::{Rows, Sorting};

#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    pub nodes: Vec<Vector>,
    pub boundaries: Vec<BoundarySet>,
    pub tetrahedra: Vec<[u32; 4]>,
    /// Nodes at one place, one list for each place.
    pub copies: Vec<Vec<u32>>,
    /// Nodes of a boundary that have been put beside it.
    pub beside: Vec<u32>,
}

/// The faces of a tetrahedron by its local nodes, counter-clockwise seen from outside.
pub(super) const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

impl Draft {
    pub fn corners(&self, tet: &[u32; 4]) -> [Vector; 4] {
        tet.map(|node| self.nodes[node as usize])
    }

    pub fn worst_sine(&self, tet: &[u32; 4]) -> f64 {
        worst_sine(&self.corners(tet))
    }

    /// In mm³.
    pub fn volume(&self, tet: &[u32; 4]) -> f64 {
        determinant(&self.corners(tet)) / 6.0
    }

    /// For each node its tetrahedra, ascending.
    pub fn tetrahedra_of_nodes(&self) -> Rows<u32> {
        let mut lengths = vec![0; self.nodes.len()];
        let nodes = self.tetrahedra.iter().flatten();
        nodes.for_each(|&node| lengths[node as usize] += 1);
        let mut sorting = Sorting::new(&lengths, 0);
        for (number, tet) in self.tetrahedra.iter().enumerate() {
            tet.iter().for_each(|&node| sorting.put(node as usize, number as u32));
        }
        sorting.finish()
    }

    /// Keeps some tetrahedra and their nodes, which are numbered as they come.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let mut numbers = vec![u32::MAX; self.nodes.len()];
        let old = std::mem::take(self);
        let kept = old.tetrahedra.iter().enumerate().filter(|(tet, _)| keep(*tet));
        for (_, tet) in kept {
            let renumbered = tet.map(|node| {
                let number = &mut numbers[node as usize];
                if *number == u32::MAX {
                    *number = self.nodes.len() as u32;
                    self.nodes.push(old.nodes[node as usize]);
                    self.boundaries.push(old.boundaries[node as usize]);
                }
                *number
            });
            self.tetrahedra.push(renumbered);
        }
        let lists = std::iter::once(&old.beside).chain(&old.copies).map(|list| {
            let numbers = list.iter().map(|&node| numbers[node as usize]);
            numbers.filter(|&number| number != u32::MAX).collect::<Vec<u32>>()
        });
        let mut lists = lists.collect::<Vec<_>>().into_iter();
        self.beside = lists.next().unwrap_or_default();
        self.copies = lists.filter(|list| list.len() > 1).collect();
    }
}
