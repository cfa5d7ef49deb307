//! The lattice warped onto the boundary: nodes that lie close to a cut are moved onto it.
//!
//! Source: Labelle, Shewchuk, Isosurface stuffing, ACM Transactions on Graphics 26 (2007), section 3: with the limits
//! below all dihedral angles of a uniform lattice are above 10.7 degrees. Graded lattices are not covered by the proof, nor
//! is what is done where tissue touches itself (`release`).

use rayon::prelude::*;

use super::boundary_set::BoundarySet;
use super::cuts::{Cuts, cut_between};
use super::lattice::Lattice;
use super::shape::worst_sine;
use crate::domain::Domain;
use crate::mesh::Vector;
use crate::rows::{Rows, Sorting};

/// How near a cut must be, in parts of its edge, to have a node moved onto it: on edges along an axis, from the corner of a
/// cube to its centre, and on those that only graded lattices have.
const ALONG_AXIS: f64 = 0.249_99;
const TO_CENTRE: f64 = 0.411_89;
const OTHER: f64 = 0.25;

/// A node that is put back is moved away from its cut until that is at this part of the edge.
const STEPPED_BACK: f64 = 0.3;
/// A tetrahedron of the warped lattice with a smaller sine is not kept.
const POOR: f64 = 0.08;
/// Cuts are no nearer to the end of their edge than this part of it.
const NEAREST: f64 = 0.05;

/// Where a node of the warped lattice lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Inside,
    Boundary,
    Outside,
}

pub(super) struct Warp<'a> {
    pub lattice: &'a Lattice,
    pub cuts: Cuts,
    pub domain: &'a dyn Domain,
    pub position: Vec<Vector>,
    pub side: Vec<Side>,
    /// Of the nodes moved onto it.
    pub boundary: Vec<BoundarySet>,
    /// How far a node was moved, in parts of what was allowed.
    moved: Vec<f32>,
    /// For each node with cuts its tetrahedra; empty for others.
    pub tetrahedra_of: Rows<u32>,
    pub snapped: usize,
    /// Nodes put back because a cell would have been flat.
    pub undone: usize,
}

/// A node, and the cut that it may be moved onto.
struct Candidate {
    /// The distance over the one allowed.
    share: f64,
    node: u32,
    cut: u32,
}

impl<'a> Warp<'a> {
    pub fn new(lattice: &'a Lattice, cuts: Cuts, domain: &'a dyn Domain) -> Self {
        let nodes = lattice.coordinates.len();
        let numbers = 0..nodes as u32;
        let side = |&inside: &bool| if inside { Side::Inside } else { Side::Outside };
        let mut warp = Warp {
            position: numbers.into_par_iter().map(|node| lattice.position(node)).collect(),
            side: lattice.inside.iter().map(side).collect(),
            boundary: vec![BoundarySet::NONE; nodes],
            moved: vec![0.0; nodes],
            tetrahedra_of: tetrahedra_at_cuts(lattice, &cuts),
            snapped: 0,
            undone: 0,
            lattice,
            cuts,
            domain,
        };
        warp.snap();
        warp.undo_flat();
        warp
    }

    /// Moves nodes onto cuts, the nearest first.
    fn snap(&mut self) {
        let mut candidates = self.candidates();
        let nearest_first = |a: &Candidate, b: &Candidate| {
            a.share.total_cmp(&b.share).then((a.node, a.cut).cmp(&(b.node, b.cut)))
        };
        candidates.par_sort_unstable_by(nearest_first);
        for Candidate { share, node, cut } in candidates {
            let cut = self.cuts.list[cut as usize];
            if self.is_alive(cut.inside, cut.outside) {
                self.side[node as usize] = Side::Boundary;
                self.position[node as usize] = cut.point;
                self.boundary[node as usize] = cut.boundary.into();
                self.moved[node as usize] = share as f32;
                self.snapped += 1;
            }
        }
    }

    fn candidates(&self) -> Vec<Candidate> {
        let cuts = self.cuts.list.par_iter().enumerate();
        cuts.flat_map_iter(|(number, cut)| {
            let ends = [cut.inside, cut.outside];
            let [from, to] = ends.map(|node| self.position[node as usize]);
            let allowed = self.allowed(cut.inside, cut.outside) * (to - from).norm();
            ends.into_iter().filter_map(move |node| {
                let end = if node == cut.inside { from } else { to };
                let share = (cut.point - end).norm() / allowed;
                (share < 1.0).then_some(Candidate { share, node, cut: number as u32 })
            })
        })
        .collect()
    }

    fn allowed(&self, one: u32, other: u32) -> f64 {
        let [a, b] = [one, other].map(|node| self.lattice.coordinates[node as usize]);
        let [x, y, z] = [0, 1, 2].map(|axis| a[axis].abs_diff(b[axis]));
        match [x, y, z].into_iter().filter(|&step| step == 0).count() {
            2 => ALONG_AXIS,
            0 if x == y && y == z => TO_CENTRE,
            _ => OTHER,
        }
    }

    /// The cut between two nodes is there: neither has been moved onto the boundary.
    fn is_alive(&self, inside: u32, outside: u32) -> bool {
        self.side[inside as usize] == Side::Inside && self.side[outside as usize] == Side::Outside
    }

    /// A tetrahedron has tissue in it.
    pub fn is_kept(&self, tet: u32) -> bool {
        let nodes = self.lattice.tetrahedra[tet as usize];
        nodes.iter().any(|&node| self.side[node as usize] == Side::Inside)
    }

    fn sine(&self, tet: u32) -> f64 {
        worst_sine(&self.lattice.tetrahedra[tet as usize].map(|node| self.position[node as usize]))
    }

    /// Undoes the warp of nodes until no tetrahedron with tissue is flat or inverted.
    fn undo_flat(&mut self) {
        loop {
            let all = 0..self.lattice.tetrahedra.len() as u32;
            let flat: Vec<u32> = all
                .into_par_iter()
                .filter(|&tet| self.farthest(tet).is_some() && self.sine(tet) < POOR)
                .collect();
            let flat: Vec<u32> = flat.into_iter().filter(|&tet| self.is_kept(tet)).collect();
            if flat.is_empty() {
                return;
            }
            for tet in flat {
                if let Some(node) = self.farthest(tet)
                    && self.sine(tet) < POOR
                {
                    self.undone += 1;
                    self.undo_warp(node);
                }
            }
        }
    }

    /// The node of a tetrahedron that was moved farthest, if any was.
    fn farthest(&self, tet: u32) -> Option<u32> {
        let nodes = self.lattice.tetrahedra[tet as usize].into_iter();
        let moved = nodes.filter(|&node| self.side[node as usize] == Side::Boundary);
        let by_way = |a: &u32, b: &u32| {
            self.moved[*a as usize].total_cmp(&self.moved[*b as usize]).then(b.cmp(a))
        };
        moved.max_by(by_way)
    }

    /// Of two nodes the one that may rather be put back.
    pub fn looser(&self, one: u32, other: u32) -> u32 {
        let way = |node: u32| self.moved[node as usize];
        if way(other) > way(one) { other } else { one }
    }

    fn undo_warp(&mut self, node: u32) {
        let inside = self.lattice.inside[node as usize];
        self.side[node as usize] = if inside { Side::Inside } else { Side::Outside };
        self.position[node as usize] = self.lattice.position(node);
        self.boundary[node as usize] = BoundarySet::NONE;
        self.moved[node as usize] = 0.0;
    }

    /// Moves a node back and away from the boundary, so that its cuts are not too near to it.
    pub fn release(&mut self, node: u32) {
        self.undo_warp(node);
        let Some(back) = self.position_away_from_cut(node) else { return };
        let at_lattice = std::mem::replace(&mut self.position[node as usize], back);
        let inside = self.lattice.inside[node as usize];
        let good = (self.domain.value(&back) > 0.0) == inside
            && self.tetrahedra_of.row(node as usize).iter().all(|&tet| self.sine(tet) > 2.0 * POOR);
        if !good {
            self.position[node as usize] = at_lattice;
            return;
        }
        for &number in self.cuts.of_node.row(node as usize) {
            let ends =
                [self.cuts.list[number as usize].inside, self.cuts.list[number as usize].outside];
            if self.is_alive(ends[0], ends[1]) {
                let places = ends.map(|end| self.position[end as usize]);
                self.cuts.list[number as usize] = cut_between(self.domain, ends, places);
            }
        }
    }

    /// Position of a node that is too near to one of its cuts.
    fn position_away_from_cut(&self, node: u32) -> Option<Vector> {
        let here = self.position[node as usize];
        let of_node = self.cuts.of_node.row(node as usize).iter();
        let alive = of_node.map(|&cut| &self.cuts.list[cut as usize]);
        let alive = alive.filter(|cut| self.is_alive(cut.inside, cut.outside));
        let shares = alive.map(|cut| {
            let other = if cut.inside == node { cut.outside } else { cut.inside };
            let edge = self.position[other as usize] - here;
            ((cut.point - here).norm() / edge.norm(), edge)
        });
        let (share, edge) = shares.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let way = (STEPPED_BACK - share) / (1.0 - STEPPED_BACK);
        (way > 0.0).then(|| here - edge * way)
    }

    /// Where the cut of two nodes is put: on the boundary unless that is at the end of the edge.
    pub fn cut_point(&self, cut: u32) -> Vector {
        let cut = &self.cuts.list[cut as usize];
        let [from, to] = [cut.inside, cut.outside].map(|node| self.position[node as usize]);
        let share = (cut.point - from).norm() / (to - from).norm();
        if (NEAREST..=1.0 - NEAREST).contains(&share) {
            return cut.point;
        }
        from + (to - from) * share.clamp(NEAREST, 1.0 - NEAREST)
    }
}

fn tetrahedra_at_cuts(lattice: &Lattice, cuts: &Cuts) -> Rows<u32> {
    let has_cuts = |&&node: &&u32| !cuts.of_node.range(node as usize).is_empty();
    let mut lengths = vec![0; lattice.coordinates.len()];
    for tet in &lattice.tetrahedra {
        tet.iter().filter(has_cuts).for_each(|&node| lengths[node as usize] += 1);
    }
    let mut sorting = Sorting::new(&lengths, 0);
    for (number, tet) in lattice.tetrahedra.iter().enumerate() {
        tet.iter().filter(has_cuts).for_each(|&node| sorting.put(node as usize, number as u32));
    }
    sorting.finish()
}
