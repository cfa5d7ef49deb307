//! Local refinement of tetrahedra by bisection: cells that are asked for are halved, and of their neighbours as many as keep
//! the mesh conforming.
//!
//! Nodes keep their numbers, new ones come after them in the order in which edges are halved, and the halves of a cell stand
//! in its place, so that the same mesh and the same cells give the same bytes. Edges are halved where they are: flat faces
//! stay flat, and the boundary is that of the first mesh. `carried` says what becomes of sets, labels and arrays.

mod carried;
mod marked_tetrahedron;

use std::collections::HashMap;
use std::sync::Arc;

use super::{CellShape, Vector, VolumeMesh};
use marked_tetrahedron::{MarkedTetrahedron, ends};

pub use carried::Carrier;

/// Bisections after which every edge of a cell is halved.
pub const HALVES_EVERY_EDGE: u8 = 3;

/// A mesh whose cells are halved again and again.
#[derive(Clone, Debug)]
pub struct Bisection {
    /// The mesh that it began with.
    first: Arc<VolumeMesh>,
    /// All nodes, those of the first mesh first.
    positions: Vec<Vector>,
    /// The nodes between which each new one lies.
    parents: Vec<[u32; 2]>,
    /// For each new node the corners of the edge, face or cell of the first mesh inside which it lies, ascending.
    supports: Vec<Support>,
    cells: Vec<MarkedTetrahedron>,
}

/// Why a mesh is not refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "only tetrahedra are refined where an estimate asks for it, and {cells} of {all} cells are hexahedra or wedges: take a mesh \
     of tetrahedra, or refine all cells alike"
)]
pub struct NotTetrahedra {
    pub cells: usize,
    pub all: usize,
}

/// Corners of an edge, a face or a cell of the first mesh, ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Support {
    nodes: [u32; 4],
    count: u8,
}

/// A cell during a refinement.
struct BisectedCell {
    cell: MarkedTetrahedron,
    /// How many times it has yet to be halved because it was asked for.
    asked: u8,
    halves: Option<[usize; 2]>,
}

impl Support {
    fn of(node: u32) -> Self {
        Support { nodes: [node, 0, 0, 0], count: 1 }
    }

    fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count as usize]
    }

    /// The smallest edge, face or cell that has both; they belong to one cell.
    fn with(mut self, other: &Support) -> Self {
        for &node in other.nodes() {
            let place = self.nodes().partition_point(|&own| own < node);
            if self.nodes().get(place) == Some(&node) {
                continue;
            }
            self.nodes[place..].rotate_right(1);
            self.nodes[place] = node;
            self.count += 1;
        }
        self
    }
}

impl Bisection {
    pub fn new(first: Arc<VolumeMesh>) -> Result<Self, NotTetrahedra> {
        let all = first.cells.len();
        let cells = first.cells.iter().filter(|(shape, _)| *shape != CellShape::Tet4).count();
        if cells > 0 {
            return Err(NotTetrahedra { cells, all });
        }
        let marked = |(root, (_, nodes)): (u32, (CellShape, &[u32]))| {
            let nodes = [nodes[0], nodes[1], nodes[2], nodes[3]];
            MarkedTetrahedron::new(nodes, root, &first.nodes)
        };
        let cells = (0_u32..).zip(first.cells.iter()).map(marked).collect();
        let positions = first.nodes.clone();
        Ok(Bisection { first, positions, parents: Vec::new(), supports: Vec::new(), cells })
    }

    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Halves some cells `times` times, their halves included, and others as far as that asks for it.
    pub fn refine(&mut self, asked: &[usize], times: u8) {
        let mut asked_of = vec![0; self.cells.len()];
        asked.iter().for_each(|&cell| asked_of[cell] = times);
        let count = self.cells.len();
        let cells = std::mem::take(&mut self.cells);
        let mut twigs: Vec<BisectedCell> = cells
            .into_iter()
            .zip(asked_of)
            .map(|(cell, asked)| BisectedCell { cell, asked, halves: None })
            .collect();

        // 1. Until no cell is asked for and none has a node in the middle of an edge.
        let mut split: HashMap<[u32; 2], u32> = HashMap::new();
        let mut touched = vec![false; self.positions.len()];
        loop {
            let has_middle = |cell: &MarkedTetrahedron| {
                let mut edges = cell.edges().into_iter();
                edges.any(|edge| {
                    edge.iter().all(|&end| touched[end as usize]) && split.contains_key(&edge)
                })
            };
            let is_due = |twig: &BisectedCell| {
                twig.halves.is_none() && (twig.asked > 0 || has_middle(&twig.cell))
            };
            let due: Vec<usize> = (0..twigs.len()).filter(|&twig| is_due(&twigs[twig])).collect();
            if due.is_empty() {
                break;
            }
            for twig in due {
                let edge = twigs[twig].cell.next();
                let middle = *split.entry(edge).or_insert_with(|| self.halve(edge));
                touched.resize(self.positions.len(), false);
                edge.iter().for_each(|&end| touched[end as usize] = true);
                let asked = twigs[twig].asked.saturating_sub(1);
                twigs[twig].halves = Some([twigs.len(), twigs.len() + 1]);
                let halves = twigs[twig].cell.halves(middle);
                twigs.extend(halves.map(|cell| BisectedCell { cell, asked, halves: None }));
            }
        }

        // 2. The cells that are left, each in the place of the one that it came from.
        let mut ahead: Vec<usize> = (0..count).rev().collect();
        while let Some(twig) = ahead.pop() {
            match twigs[twig].halves {
                Some([first, second]) => ahead.extend([second, first]),
                None => self.cells.push(twigs[twig].cell),
            }
        }
    }

    /// A node in the middle of an edge.
    fn halve(&mut self, [a, b]: [u32; 2]) -> u32 {
        let node = self.positions.len() as u32;
        let support = self.support(a).with(&self.support(b));
        self.positions.push((self.positions[a as usize] + self.positions[b as usize]) * 0.5);
        self.parents.push(ends(a, b));
        self.supports.push(support);
        node
    }

    fn support(&self, node: u32) -> Support {
        let new = (node as usize).checked_sub(self.first.nodes.len());
        new.map_or_else(|| Support::of(node), |new| self.supports[new])
    }
}
