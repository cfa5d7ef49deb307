//! Stencils that fill the part of each lattice tetrahedron that is tissue.
//!
//! By the sides of the four nodes, inside, on the boundary or outside: one inside gives a tetrahedron, two inside and one on
//! the boundary a pyramid, else a prism. Both tetrahedra at a face of the lattice cut a quadrilateral on it along the same
//! diagonal, the shorter one; that of a quadrilateral on the boundary is free, and the better one is taken.
//!
//! Source: Labelle, Shewchuk, Isosurface stuffing, ACM Transactions on Graphics 26 (2007), figure 3.

use super::boundary_set::BoundarySet;
use super::draft::Draft;
use super::error::MeshingError;
use super::pinches::Fans;
use super::prism::Prism;
use super::shape::worst_sine;
use super::warp::{Side, Warp};
use super::watch::Watch;
use crate::mesh::Vector;

/// Marks, in place of the first node, a lattice tetrahedron whose prism needs a node in its middle.
const NEEDS_MIDDLE: u32 = u32::MAX;

/// Nodes are numbered: those of the lattice, the cuts, further copies of lattice nodes.
struct Stencils<'a> {
    warp: &'a Warp<'a>,
    fans: &'a Fans,
    /// The first further copy of each lattice node.
    copies: Vec<u32>,
    cut_points: Vec<Vector>,
    lattice_nodes: u32,
}

/// A lattice tetrahedron, its nodes inside first, then those on the boundary, the right way round.
#[derive(Clone, Copy)]
struct Parent {
    number: u32,
    nodes: [u32; 4],
    inside: usize,
    outside: usize,
}

/// Fills the warped lattice.
pub(super) fn fill(warp: &Warp, fans: &Fans, watch: &Watch) -> Result<Draft, MeshingError> {
    let cuts: Vec<u32> = (0..warp.cuts.list.len() as u32).collect();
    let cut_points = watch.map(&cuts, |&cut| warp.cut_point(cut))?;
    let lattice_nodes = warp.side.len() as u32;
    let mut next = lattice_nodes + cut_points.len() as u32;
    let copies = fans.count.iter().map(|&count| {
        let first = next;
        next += u32::from(count.saturating_sub(1));
        first
    });
    let copies = copies.collect();
    let stencils = Stencils { warp, fans, copies, cut_points, lattice_nodes };
    let numbers: Vec<u32> = (0..warp.lattice.tetrahedra.len() as u32).collect();
    let filled = watch.gather(&numbers, |numbers, list| {
        numbers.iter().for_each(|&tet| stencils.fill(tet, list));
    })?;
    Ok(stencils.draft(filled))
}

impl Stencils<'_> {
    fn fill(&self, number: u32, list: &mut Vec<[u32; 4]>) {
        let Some(parent) = self.parent(number) else { return };
        let Parent { nodes, inside, outside, .. } = parent;
        match (inside, outside) {
            (_, 0) => list.push(nodes.map(|node| self.copy(node, number))),
            (1, _) => list.push(self.corner(&parent)),
            (2, 1) => list.extend(self.pyramid(&parent)),
            _ => match self.prism(&parent).tetrahedra() {
                Some(tetrahedra) => list.extend(tetrahedra),
                None => list.push([NEEDS_MIDDLE, number, 0, 0]),
            },
        }
    }

    /// None where there is no tissue in it.
    fn parent(&self, number: u32) -> Option<Parent> {
        let mut nodes = self.warp.lattice.tetrahedra[number as usize];
        let side = |node: u32| self.warp.side[node as usize];
        let count = |wanted| nodes.iter().filter(|&&node| side(node) == wanted).count();
        let (inside, outside) = (count(Side::Inside), count(Side::Outside));
        if inside == 0 {
            return None;
        }
        if outside > 0 {
            let mut odd = false;
            for end in (1..4).rev() {
                for place in 0..end {
                    if side(nodes[place]) as u8 > side(nodes[place + 1]) as u8 {
                        nodes.swap(place, place + 1);
                        odd = !odd;
                    }
                }
            }
            if odd {
                // Four nodes on three sides: two neighbours are on one.
                let place = (0..3).find(|&place| side(nodes[place]) == side(nodes[place + 1]));
                place.into_iter().for_each(|place| nodes.swap(place, place + 1));
            }
        }
        Some(Parent { number, nodes, inside, outside })
    }

    /// The copy of a lattice node that a tetrahedron has.
    fn copy(&self, node: u32, tet: u32) -> u32 {
        if self.fans.count[node as usize] < 2 {
            return node;
        }
        match self.fans.of(self.warp, node, tet) {
            0 => node,
            fan => self.copies[node as usize] + u32::from(fan) - 1,
        }
    }

    fn cut(&self, inside: u32, outside: u32) -> u32 {
        let cut = self.warp.cuts.between(inside, outside);
        self.lattice_nodes + cut.expect("an edge between two sides is cut")
    }

    fn corner(&self, parent: &Parent) -> [u32; 4] {
        let [tip, ..] = parent.nodes;
        parent.nodes.map(|node| match self.warp.side[node as usize] {
            Side::Inside => node,
            Side::Boundary => self.copy(node, parent.number),
            Side::Outside => self.cut(tip, node),
        })
    }

    fn pyramid(&self, parent: &Parent) -> [[u32; 4]; 2] {
        let [one, two, on, out] = parent.nodes;
        let apex = self.copy(on, parent.number);
        let [cut_one, cut_two] = [self.cut(one, out), self.cut(two, out)];
        if self.is_cut_from(one, two, out) {
            [[one, two, apex, cut_two], [one, cut_two, apex, cut_one]]
        } else {
            [[one, two, apex, cut_one], [two, cut_two, apex, cut_one]]
        }
    }

    fn prism(&self, parent: &Parent) -> Prism {
        let [a, b, c, d] = parent.nodes;
        if parent.inside == 3 {
            let high = [a, b, c].map(|node| self.cut(node, d));
            let rises =
                [self.is_cut_from(a, b, d), self.is_cut_from(b, c, d), self.is_cut_from(c, a, d)];
            return Prism { low: [a, b, c], high, rises };
        }
        let low = [a, self.cut(a, c), self.cut(a, d)];
        let high = [b, self.cut(b, c), self.cut(b, d)];
        let [first, last] = [self.is_cut_from(a, b, c), !self.is_cut_from(a, b, d)];
        let choices = [true, false].map(|free| Prism { low, high, rises: [first, free, last] });
        let [one, other] = choices.map(|prism| self.worst_sine(&prism));
        choices[usize::from(other > one)]
    }

    /// The diagonal of the quadrilateral between two inner nodes and their cuts towards an outer one begins at the first of
    /// them: the shorter of both. The answer is the same for both tetrahedra at the face.
    fn is_cut_from(&self, one: u32, two: u32, out: u32) -> bool {
        let [low, high] = [one.min(two), one.max(two)];
        let from = |node: u32, other: u32| {
            (self.place(node) - self.place(self.cut(other, out))).norm_squared()
        };
        (from(low, high) <= from(high, low)) == (one == low)
    }

    fn worst_sine(&self, prism: &Prism) -> f64 {
        let sine = |tet: [u32; 4]| worst_sine(&tet.map(|node| self.place(node)));
        let all = prism.tetrahedra().map(|all| all.map(sine).into_iter().fold(1.0, f64::min));
        all.unwrap_or(-1.0)
    }

    fn place(&self, node: u32) -> Vector {
        let cut = node.checked_sub(self.lattice_nodes);
        match cut.and_then(|cut| self.cut_points.get(cut as usize)) {
            Some(point) => *point,
            None => self.warp.position[node as usize],
        }
    }

    /// The mesh of some of these tetrahedra.
    fn draft(&self, mut filled: Vec<[u32; 4]>) -> Draft {
        let mut all = self.all_nodes();
        let marked = filled.iter().filter(|tet| tet[0] == NEEDS_MIDDLE);
        let parents: Vec<Parent> = marked.filter_map(|tet| self.parent(tet[1])).collect();
        filled.retain(|tet| tet[0] != NEEDS_MIDDLE);
        for parent in parents {
            let prism = self.prism(&parent);
            let corners = prism.low.into_iter().chain(prism.high);
            let middle = corners.map(|node| all.nodes[node as usize]).sum::<Vector>() / 6.0;
            filled.extend(prism.around(all.nodes.len() as u32));
            all.nodes.push(middle);
            all.boundaries.push(BoundarySet::NONE);
        }
        all.tetrahedra = filled;
        all.retain(|_| true);
        all
    }

    /// All nodes that may be used, by their numbers.
    fn all_nodes(&self) -> Draft {
        let mut draft = Draft {
            nodes: self.warp.position.clone(),
            boundaries: self.warp.boundary.clone(),
            ..Draft::default()
        };
        let cuts = &self.warp.cuts.list;
        let points = self.lattice_nodes..;
        let placed = points.zip(cuts.iter().zip(&self.cut_points));
        draft.beside =
            placed.filter(|(_, (cut, point))| cut.point != **point).map(|(node, _)| node).collect();
        draft.nodes.extend(&self.cut_points);
        draft.boundaries.extend(cuts.iter().map(|cut| BoundarySet::from(cut.boundary)));
        for (node, &count) in self.fans.count.iter().enumerate().filter(|(_, count)| **count > 1) {
            let first = self.copies[node];
            let further = first..first + u32::from(count) - 1;
            draft.copies.push(std::iter::once(node as u32).chain(further.clone()).collect());
            for _ in further {
                draft.nodes.push(self.warp.position[node]);
                draft.boundaries.push(self.warp.boundary[node]);
            }
        }
        draft
    }
}
