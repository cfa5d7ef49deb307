//! Sheets and gaps thinner than a cell: changes of tissue between the nodes of a lattice edge.

use super::grid::{Coordinates, Grid};
use super::octree::OctreeCell;
use crate::domain::Domain;
use crate::mesh::Vector;

/// A cell is halved where a middle lies deeper on the other side than this part of the edge.
const HALVED: f64 = 0.05;
/// Tissue thicker than so many cells at a middle in tissue is not looked at.
const BROAD: f64 = 2.5;

/// An edge of the lattice with both ends on one side.
pub(super) struct Edge {
    pub ends: [Vector; 2],
    pub inside: bool,
}

impl Edge {
    /// Its middle, if that lies on the other side, and deeper than a part of the edge.
    pub fn missed(&self, domain: &dyn Domain, deep: f64) -> Option<Vector> {
        let [from, to] = self.ends;
        let middle = (from + to) / 2.0;
        if (domain.value(&middle) > 0.0) == self.inside {
            return None;
        }
        let [inside, outside] = if self.inside { [from, middle] } else { [middle, from] };
        let boundary = domain.crossing(&inside, &outside).boundary;
        let depth = (domain.projection(&middle, boundary) - middle).norm();
        (depth > deep * (to - from).norm()).then_some(middle)
    }
}

/// Whether an edge of the lattice of a cell misses tissue. Edges that several cells share are looked at from one.
pub(super) fn misses_tissue(domain: &dyn Domain, grid: &Grid, cell: &OctreeCell) -> bool {
    let nodes = Nodes::new(domain, grid, cell);
    let broad = BROAD * nodes.edge;
    if nodes.centre.inside && domain.thickness_below(&nodes.centre.at, broad) >= broad {
        return false;
    }
    let missed = |edge: Edge| !edge.inside && edge.missed(domain, HALVED).is_some();
    nodes.edges(domain).into_iter().any(missed)
}

/// A node of the lattice.
#[derive(Clone, Copy)]
struct Node {
    at: Vector,
    inside: bool,
}

impl Node {
    fn new(domain: &dyn Domain, at: Vector) -> Node {
        Node { at, inside: domain.value(&at) > 0.0 }
    }

    /// None where the boundary lies between both.
    fn to(self, other: Node) -> Option<Edge> {
        let ends = [self.at, other.at];
        (self.inside == other.inside).then_some(Edge { ends, inside: self.inside })
    }
}

/// The nodes of the lattice of a cell.
struct Nodes {
    centre: Node,
    corners: [Node; 8],
    /// In mm.
    edge: f64,
}

impl Nodes {
    fn new(domain: &dyn Domain, grid: &Grid, cell: &OctreeCell) -> Nodes {
        let size = grid.cell_units(cell.level);
        let node = |at: Coordinates| Node::new(domain, grid.position(at));
        let corner = |corner: u32| {
            node([0, 1, 2].map(|axis| cell.corner[axis] + (corner >> axis & 1) * size))
        };
        Nodes {
            centre: node(cell.corner.map(|coordinate| coordinate + size / 2)),
            corners: [0, 1, 2, 3, 4, 5, 6, 7].map(corner),
            edge: f64::from(size) * grid.unit,
        }
    }

    /// From the centre to the corners, and towards higher coordinates from the lowest corner and to the next centres.
    fn edges(&self, domain: &dyn Domain) -> Vec<Edge> {
        let mut edges: Vec<Option<Edge>> =
            self.corners.iter().map(|&corner| self.centre.to(corner)).collect();
        for axis in 0..3 {
            edges.push(self.corners[0].to(self.corners[1 << axis]));
            let mut there = self.centre.at;
            there[axis] += self.edge;
            edges.push(self.centre.to(Node::new(domain, there)));
        }
        edges.into_iter().flatten().collect()
    }
}
