//! The body-centred cubic lattice of a balanced octree: nodes at the corners and in the centres of its leaves, and
//! tetrahedra that fill it without hanging nodes.
//!
//! * A face between leaves of one size: a tetrahedron for each edge of the face, with the centres of both leaves; two where
//!   a smaller leaf has a node in the middle of the edge.
//! * A face of a leaf against a larger one: its diagonal from the corner of the larger face to the middle of that makes two
//!   triangles; each is joined to the centre of either leaf.

use super::error::MeshingError;
use super::grid::{Coordinates, Grid};
use super::node_table::NodeTable;
use super::octree::{Leaf, Leaves};
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;

/// Corners of a leaf have bit 0 set on the high side of x, bit 1 of y, bit 2 of z. These are those on the high face of each
/// axis, counter-clockwise seen from there.
const HIGH_FACE: [[usize; 4]; 3] = [[1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6]];

pub(super) struct Lattice {
    pub grid: Grid,
    pub coordinates: Vec<Coordinates>,
    /// Which nodes lie in tissue.
    pub inside: Vec<bool>,
    /// The nodes at the corners of each leaf. The node in its centre has the number of the leaf.
    pub corners: Vec<[u32; 8]>,
    /// Those with a node in tissue, positively oriented, along the space-filling curve of the leaves.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// The nodes of the leaves: first their centres, then their corners.
struct Nodes<'a> {
    leaves: &'a Leaves,
    coordinates: Vec<Coordinates>,
    corners: Vec<[u32; 8]>,
    table: NodeTable,
}

impl Lattice {
    pub fn new(
        leaves: &Leaves,
        domain: &dyn Domain,
        watch: &Watch,
    ) -> Result<Lattice, MeshingError> {
        let nodes = Nodes::new(leaves);
        watch.check_cancelled()?;
        let inside = nodes.inside(domain, watch)?;
        let numbers: Vec<u32> = (0..leaves.list.len() as u32).collect();
        let tetrahedra = watch.gather(&numbers, |numbers, list| {
            let mut tetrahedra = Vec::with_capacity(24);
            for &leaf in numbers {
                tetrahedra.clear();
                nodes.tetrahedra(leaf, &mut tetrahedra);
                let in_tissue = |tet: &&[u32; 4]| tet.iter().any(|&node| inside[node as usize]);
                list.extend(tetrahedra.iter().filter(in_tissue));
            }
        })?;
        let Nodes { coordinates, corners, .. } = nodes;
        let grid = leaves.tree.grid.clone();
        Ok(Lattice { grid, coordinates, inside, corners, tetrahedra })
    }

    pub fn position(&self, node: u32) -> Vector {
        self.grid.position(self.coordinates[node as usize])
    }
}

impl<'a> Nodes<'a> {
    fn new(leaves: &'a Leaves) -> Self {
        let centre = |leaf: &Leaf| leaf.corner.map(|coordinate| coordinate + leaf.size / 2);
        let mut coordinates: Vec<Coordinates> = leaves.list.iter().map(centre).collect();
        let mut table = NodeTable::with_room(leaves.list.len() * 3 / 2);
        let mut corners = Vec::with_capacity(leaves.list.len());
        for leaf in &leaves.list {
            corners.push([0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
                let at = corner_of(leaf, corner);
                let next = coordinates.len() as u32;
                let number = table.number(Grid::key(at), next);
                if number == next {
                    coordinates.push(at);
                }
                number
            }));
        }
        Nodes { leaves, coordinates, corners, table }
    }

    /// Which nodes lie in tissue: by what their leaves are known to hold, else by the sign of the body's function.
    fn inside(&self, domain: &dyn Domain, watch: &Watch) -> Result<Vec<bool>, MeshingError> {
        let mut held = vec![Coverage::Mixed; self.coordinates.len()];
        for (centre, (leaf, corners)) in self.leaves.list.iter().zip(&self.corners).enumerate() {
            if leaf.held != Coverage::Mixed {
                held[centre] = leaf.held;
                corners.iter().for_each(|&corner| held[corner as usize] = leaf.held);
            }
        }
        let nodes = 0..held.len() as u32;
        let unknown: Vec<u32> =
            nodes.filter(|&node| held[node as usize] == Coverage::Mixed).collect();
        let place = |node: u32| self.leaves.tree.grid.position(self.coordinates[node as usize]);
        let values = watch.map(&unknown, |&node| domain.value(&place(node)))?;
        let mut inside: Vec<bool> = held.iter().map(|&held| held == Coverage::Inside).collect();
        for (&node, value) in unknown.iter().zip(values) {
            if !value.is_finite() {
                return Err(MeshingError::NotFinite { what: "value", at: place(node) });
            }
            inside[node as usize] = value > 0.0;
        }
        Ok(inside)
    }

    /// Adds the tetrahedra at the faces of a leaf that it answers for: towards higher leaves of its size and all larger.
    fn tetrahedra(&self, number: u32, list: &mut Vec<[u32; 4]>) {
        let leaf = &self.leaves.list[number as usize];
        for (axis, face) in HIGH_FACE.into_iter().enumerate() {
            for high in [false, true] {
                let mut beyond = leaf.corner;
                beyond[axis] =
                    if high { beyond[axis] + leaf.size } else { beyond[axis].wrapping_sub(1) };
                let Some(other) = self.leaves.at(beyond) else { continue };
                let neighbour = &self.leaves.list[other as usize];
                if leaf.held == Coverage::Outside && neighbour.held == Coverage::Outside {
                    continue;
                }
                let face = if high { face } else { face.map(|corner| corner - (1 << axis)) };
                if neighbour.level < leaf.level {
                    self.against_larger(number, other, face, list);
                } else if neighbour.level == leaf.level && high {
                    self.between_equals(number, other, face, list);
                }
            }
        }
    }

    fn between_equals(&self, low: u32, high: u32, face: [usize; 4], list: &mut Vec<[u32; 4]>) {
        let leaf = &self.leaves.list[low as usize];
        let corners = &self.corners[low as usize];
        for edge in 0..4 {
            let [from, to] = [face[edge], face[(edge + 1) % 4]];
            let [a, b] = [corners[from], corners[to]];
            match self.middle(leaf, from, to) {
                Some(middle) => list.extend([[low, high, a, middle], [low, high, middle, b]]),
                None => list.push([low, high, a, b]),
            }
        }
    }

    /// The node in the middle of an edge, which smaller leaves may have put there.
    fn middle(&self, leaf: &Leaf, from: usize, to: usize) -> Option<u32> {
        if leaf.level == self.leaves.tree.grid.depth {
            return None;
        }
        let [from, to] = [corner_of(leaf, from), corner_of(leaf, to)];
        self.table.get(Grid::key([0, 1, 2].map(|axis| from[axis].midpoint(to[axis]))))
    }

    fn against_larger(&self, small: u32, large: u32, face: [usize; 4], list: &mut Vec<[u32; 4]>) {
        let corners = &self.corners[small as usize];
        let larger = &self.leaves.list[large as usize];
        let is_corner = |&turn: &usize| {
            let at = self.coordinates[corners[face[turn]] as usize];
            (0..3).all(|axis| (at[axis] - larger.corner[axis]).is_multiple_of(larger.size))
        };
        let first = (0..4).find(is_corner).unwrap_or_default();
        let [corner, one, middle, other] =
            [0, 1, 2, 3].map(|turn| corners[face[(first + turn) % 4]]);
        for apex in [small, large] {
            for triangle in [[corner, one, middle], [corner, middle, other]] {
                list.push(self.oriented(triangle, apex));
            }
        }
    }

    /// The tetrahedron over a triangle, the right way round.
    fn oriented(&self, [a, b, c]: [u32; 3], apex: u32) -> [u32; 4] {
        let at = |node: u32| self.coordinates[node as usize].map(i64::from);
        let origin = at(a);
        let [u, v, w] = [b, c, apex].map(|node| {
            let point = at(node);
            [0, 1, 2].map(|axis| point[axis] - origin[axis])
        });
        let determinant = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0]);
        if determinant > 0 { [a, b, c, apex] } else { [a, c, b, apex] }
    }
}

fn corner_of(leaf: &Leaf, corner: usize) -> Coordinates {
    [0, 1, 2].map(|axis| leaf.corner[axis] + (corner >> axis & 1) as u32 * leaf.size)
}
