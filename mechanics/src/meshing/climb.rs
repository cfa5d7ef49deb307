//! Hill climbing: nodes of bad cells are moved to where the worst cell about them is better.
//!
//! A node on a boundary goes to the nearest point of it. Nodes without a common cell have one colour and are moved at the
//! same time, each by itself, so that the result does not depend on the number of threads. No move turns a cell over.
//!
//! Source: Freitag, Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing, International Journal for
//! Numerical Methods in Engineering 40 (1997); the search along two directions is ours.

use rayon::prelude::*;

use super::draft::Draft;
use super::error::MeshingError;
use super::rims::{RimFace, boundary_faces};
use super::star::{Move, Star};
use super::watch::Watch;
use crate::domain::Domain;
use crate::rows::Rows;

/// Cells with an angle below 30 or above 150 degrees are worked on.
const BAD: f64 = 0.5;
/// Nodes beside their boundary go back to it where angles stay above 20 degrees, or do not get worse.
const FAIR: f64 = 0.35;
/// As many colours as there are bits.
const COLOURS: u32 = 64;

/// A mesh whose nodes are moved.
pub(super) struct Climb<'a> {
    pub draft: &'a mut Draft,
    pub domain: &'a dyn Domain,
    /// Of the boundary: no move changes which they are.
    pub faces: Vec<RimFace>,
    of_nodes: Rows<u32>,
    sines: Vec<f64>,
    /// Nodes for which no better place was found while their cells were as they are.
    tried: Vec<bool>,
}

impl<'a> Climb<'a> {
    pub fn new(draft: &'a mut Draft, domain: &'a dyn Domain) -> Self {
        let sines = draft.tetrahedra.par_iter().map(|tet| draft.worst_sine(tet)).collect();
        let of_nodes = draft.tetrahedra_of_nodes();
        let tried = vec![false; draft.nodes.len()];
        let faces = boundary_faces(draft);
        Climb { draft, domain, faces, of_nodes, sines, tried }
    }

    /// Moves nodes, sweep by sweep, until none moves or the sweeps are over.
    pub fn climb(&mut self, sweeps: usize, watch: &Watch) -> Result<(), MeshingError> {
        self.tried.fill(false);
        for _ in 0..sweeps {
            let nodes = self.nodes_of_bad_cells();
            let moved = self.sweep(&nodes, watch, |climb, node| {
                let is_tried = climb.tried[node as usize];
                if is_tried { None } else { climb.star(node).better() }
            })?;
            if moved == 0 {
                break;
            }
        }
        Ok(())
    }

    /// Puts nodes beside their boundary back onto it where cells stay fair.
    pub fn settle(&mut self, watch: &Watch) -> Result<(), MeshingError> {
        let nodes = self.draft.beside.clone();
        self.sweep(&nodes, watch, |climb, node| climb.star(node).on_boundary(FAIR))?;
        Ok(())
    }

    /// Moves copies of a node apart, each into its own cells, as far as those stay good.
    pub fn part_copies(&mut self) {
        let copies: Vec<u32> = self.draft.copies.concat();
        for node in copies {
            if let Some(Move { place, .. }) = self.star(node).inwards() {
                self.draft.nodes[node as usize] = place;
            }
        }
    }

    pub fn star(&self, node: u32) -> Star<'_> {
        Star::new(self.draft, node, self.of_nodes.row(node as usize), self.domain)
    }

    fn nodes_of_bad_cells(&self) -> Vec<u32> {
        let bad = self.sines.iter().zip(&self.draft.tetrahedra).filter(|(sine, _)| **sine < BAD);
        let mut nodes: Vec<u32> = bad.flat_map(|(_, tet)| *tet).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Moves each of these nodes once, colour by colour; returns how many moved.
    pub fn sweep(
        &mut self,
        nodes: &[u32],
        watch: &Watch,
        better: impl Fn(&Self, u32) -> Option<Move> + Sync,
    ) -> Result<usize, MeshingError> {
        let mut moved = 0;
        for group in self.coloured(nodes) {
            let places = watch.map(&group, |&node| better(self, node))?;
            group.iter().for_each(|&node| self.tried[node as usize] = true);
            let to = group.into_iter().zip(places).filter_map(|(node, place)| Some((node, place?)));
            let to: Vec<(u32, Move)> = to.collect();
            for &(node, Move { place, boundaries }) in &to {
                self.draft.nodes[node as usize] = place;
                self.draft.boundaries[node as usize] = boundaries;
            }
            moved += to.len();
            let changed = to.iter().flat_map(|&(node, _)| self.of_nodes.row(node as usize));
            let changed: Vec<u32> = changed.copied().collect();
            let sines = watch.map(&changed, |&tet| {
                self.draft.worst_sine(&self.draft.tetrahedra[tet as usize])
            })?;
            for (tet, sine) in changed.into_iter().zip(sines) {
                self.sines[tet as usize] = sine;
                let nodes = self.draft.tetrahedra[tet as usize];
                nodes.iter().for_each(|&node| self.tried[node as usize] = false);
            }
        }
        Ok(moved)
    }

    /// The nodes in groups without a common cell. Those for which there is no colour left are in none.
    fn coloured(&self, nodes: &[u32]) -> Vec<Vec<u32>> {
        let mut colour = vec![u32::MAX; self.draft.nodes.len()];
        let mut groups = vec![Vec::new(); COLOURS as usize];
        for &node in nodes {
            let cells = self.of_nodes.row(node as usize).iter();
            let neighbours = cells.flat_map(|&tet| self.draft.tetrahedra[tet as usize]);
            let taken = neighbours.fold(0_u64, |taken, other| match colour[other as usize] {
                u32::MAX => taken,
                used => taken | 1 << used,
            });
            let free = taken.trailing_ones();
            if free < COLOURS {
                colour[node as usize] = free;
                groups[free as usize].push(node);
            }
        }
        groups.retain(|group| !group.is_empty());
        groups
    }
}
