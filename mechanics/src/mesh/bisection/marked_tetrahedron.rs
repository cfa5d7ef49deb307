//! Marked tetrahedra: which edge of a tetrahedron is halved next, and which of its two halves.
//!
//! Every face has a marked edge, and one edge, marked on both of its faces, is the next to be halved. In the beginning these
//! are the longest ones, by a strict order that neighbours share. A half keeps the mark of the face that it has whole, which
//! says what is halved next; a face cut in two has as mark the side that is left of it whole; the new face between the halves
//! has the side opposite to the new node, but for flagged planar tetrahedra the one from the new node to the edges that
//! are halved next. So faces are marked alike from both sides, and of each tetrahedron there are only finitely many shapes.
//!
//! Source: Arnold, Mukherjee, Pouly, Locally adapted tetrahedral meshes using bisection, SIAM Journal on Scientific
//! Computing 22, 2000, section 2.

use crate::mesh::Vector;

/// Two corners of a tetrahedron.
type Edge = [usize; 2];

/// A tetrahedron that knows how it is halved.
#[derive(Clone, Copy, Debug)]
pub(super) struct MarkedTetrahedron {
    pub nodes: [u32; 4],
    /// The cell of the first mesh in which it lies.
    pub root: u32,
    /// The edge that is halved next.
    next: Edge,
    /// For each corner the marked edge of the face opposite to it.
    marked: [Edge; 4],
    is_flagged: bool,
}

/// The ends of an edge, the lower first.
pub(super) fn ends(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl MarkedTetrahedron {
    pub fn new(nodes: [u32; 4], root: u32, positions: &[Vector]) -> Self {
        let longest = |corners: &[usize]| {
            let mut longest = [corners[0], corners[1]];
            for (k, &a) in corners.iter().enumerate() {
                for &b in &corners[k + 1..] {
                    if is_longer(positions, [a, b].map(|c| nodes[c]), longest.map(|c| nodes[c])) {
                        longest = [a, b];
                    }
                }
            }
            longest
        };
        let marked = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|face| longest(&face));
        MarkedTetrahedron { nodes, root, next: longest(&[0, 1, 2, 3]), marked, is_flagged: false }
    }

    /// The ends of the edge that is halved next.
    pub fn next(&self) -> [u32; 2] {
        ends(self.nodes[self.next[0]], self.nodes[self.next[1]])
    }

    /// All its edges.
    pub fn edges(&self) -> [[u32; 2]; 6] {
        [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
            .map(|[a, b]: Edge| ends(self.nodes[a], self.nodes[b]))
    }

    /// The halves on both sides of the middle of its next edge.
    pub fn halves(&self, middle: u32) -> [MarkedTetrahedron; 2] {
        let [a, b] = self.next;
        let planar = self.common_corner();
        [[a, b], [b, a]].map(|[kept, replaced]| {
            let [c, d] = others(kept, replaced);
            let mut half = *self;
            half.nodes[replaced] = middle;
            half.next = self.marked[replaced];
            half.marked[kept] = match planar {
                Some(corner) if self.is_flagged => [replaced, corner],
                Some(_) | None => [c, d],
            };
            half.marked[c] = [kept, d];
            half.marked[d] = [kept, c];
            half.is_flagged = planar.is_some() && !self.is_flagged;
            half
        })
    }

    /// The corner in which the marked edges of the faces without the next edge meet, where these three are a triangle.
    fn common_corner(&self) -> Option<usize> {
        let [a, b] = self.next;
        let beside = |of: usize, end: usize| {
            let [p, q] = self.marked[of];
            if p == end { Some(q) } else { (q == end).then_some(p) }
        };
        let (at_b, at_a) = (beside(a, b)?, beside(b, a)?);
        (at_a == at_b).then_some(at_a)
    }
}

/// The corners beside two.
fn others(a: usize, b: usize) -> [usize; 2] {
    let mut rest = (0..4).filter(|&corner| corner != a && corner != b);
    [rest.next().unwrap_or_default(), rest.next().unwrap_or_default()]
}

/// A strict order of edges: by length, and by the numbers of their ends where lengths are equal.
fn is_longer(positions: &[Vector], edge: [u32; 2], than: [u32; 2]) -> bool {
    let length = |[a, b]: [u32; 2]| {
        let [a, b] = ends(a, b);
        (positions[b as usize] - positions[a as usize]).norm_squared()
    };
    let order = length(edge).total_cmp(&length(than));
    order.then_with(|| ends(edge[0], edge[1]).cmp(&ends(than[0], than[1]))).is_gt()
}
