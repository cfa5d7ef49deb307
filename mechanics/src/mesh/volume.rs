//! Volume meshes of mixed first-order cells with regions and named sets.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::IgnoredArrays;
use super::{TriangleSurface, Vector, bounds_of};
use crate::rows::Rows;

/// The shape of a first-order cell. Local node order is that of VTK for tetrahedra and hexahedra;
/// a wedge has its triangle 0, 1, 2 below the triangle 3, 4, 5, counter-clockwise seen from above,
/// so that its Jacobian is positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellShape {
    Tet4,
    Hex8,
    Wedge6,
}

impl CellShape {
    pub fn node_count(self) -> usize {
        match self {
            CellShape::Tet4 => 4,
            CellShape::Hex8 => 8,
            CellShape::Wedge6 => 6,
        }
    }

    /// The faces as local nodes, counter-clockwise seen from outside.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            CellShape::Tet4 => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
            CellShape::Hex8 => &[
                &[0, 3, 2, 1],
                &[4, 5, 6, 7],
                &[0, 1, 5, 4],
                &[1, 2, 6, 5],
                &[2, 3, 7, 6],
                &[3, 0, 4, 7],
            ],
            CellShape::Wedge6 => {
                &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]]
            }
        }
    }

    /// The edges as pairs of local nodes.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            CellShape::Tet4 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            CellShape::Hex8 => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
            CellShape::Wedge6 => {
                &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]]
            }
        }
    }

    /// The name used in documents and tables.
    pub fn name(self) -> &'static str {
        match self {
            CellShape::Tet4 => "tet4",
            CellShape::Hex8 => "hex8",
            CellShape::Wedge6 => "wedge6",
        }
    }
}

/// Cells of mixed shape in the order of the file they came from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    shapes: Vec<CellShape>,
    nodes: Rows<u32>,
}

impl Cells {
    /// Appends a cell. `nodes` has as many entries as the shape has nodes.
    pub fn push(&mut self, shape: CellShape, nodes: &[u32]) {
        assert_eq!(nodes.len(), shape.node_count(), "{} has other nodes", shape.name());
        self.shapes.push(shape);
        self.nodes.push(nodes.iter().copied());
    }

    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    pub fn shape(&self, cell: usize) -> CellShape {
        self.shapes[cell]
    }

    pub fn nodes(&self, cell: usize) -> &[u32] {
        self.nodes.row(cell)
    }

    pub fn nodes_mut(&mut self, cell: usize) -> &mut [u32] {
        self.nodes.row_mut(cell)
    }

    /// The cells around each of so many nodes, ascending.
    pub fn around(&self, nodes: usize) -> Rows<u32> {
        self.nodes.inverted(nodes)
    }

    /// All cells in order: shape and nodes.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (CellShape, &[u32])> {
        (0..self.len()).map(|cell| (self.shapes[cell], self.nodes(cell)))
    }
}

/// Soft tissue: nodes in mm, cells, and everything the file said about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumeMesh {
    pub nodes: Vec<Vector>,
    pub cells: Cells,
    /// Named sets of nodes, each ascending and without repeats.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of cells, each ascending and without repeats.
    pub cell_sets: BTreeMap<String, Vec<u32>>,
    /// Integer arrays with one value for each node, for `{"array", "value"}` selections.
    pub node_labels: BTreeMap<String, Vec<i64>>,
    /// Integer arrays with one value for each cell; a case names one of them as its regions.
    pub cell_labels: BTreeMap<String, Vec<i64>>,
    /// Arrays with one vector for each node, for displacements prescribed by array.
    pub node_vectors: BTreeMap<String, Vec<Vector>>,
    /// Arrays with one vector for each cell, for fibre directions; they may be zero where there are none.
    pub cell_vectors: BTreeMap<String, Vec<Vector>>,
    /// Arrays of the file that are none of these, and why.
    pub ignored: IgnoredArrays,
}

/// Diagonals whose squares differ by less than this part of their sum are equally long.
const AS_LONG: f64 = 1e-9;

/// A face that belongs to one cell only, oriented outwards; 3 or 4 nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFace {
    pub cell: u32,
    /// Of a triangle the first one comes again.
    nodes: [u32; 4],
    count: u8,
}

impl BoundaryFace {
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count as usize]
    }

    /// The face as one triangle or, cut along its shorter diagonal, as two. Of equal diagonals it is that through the corner whose
    /// coordinates come first, so that the cut does not depend on how nodes are numbered.
    pub fn triangles(&self, nodes: &[Vector]) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [a, b, c, d] = self.nodes;
        let is_triangle = self.count == 3;
        let cut = match is_triangle || self.is_cut_from_first(nodes) {
            true => [[a, b, c], [a, c, d]],
            false => [[a, b, d], [b, c, d]],
        };
        cut.into_iter().take(self.count as usize - 2)
    }

    /// Half the cross product of the diagonals, or of two edges of a triangle; outwards, in mm².
    pub fn area_vector(&self, nodes: &[Vector]) -> Vector {
        let [a, b, c, d] = self.nodes.map(|node| nodes[node as usize]);
        match self.count {
            3 => (b - a).cross(&(c - a)) * 0.5,
            _ => (c - a).cross(&(d - b)) * 0.5,
        }
    }

    /// Whether the diagonal of the first corner cuts a face of four.
    fn is_cut_from_first(&self, nodes: &[Vector]) -> bool {
        let corners = self.nodes.map(|node| nodes[node as usize]);
        let [a, b, c, d] = corners;
        let [first, second] = [(c - a).norm_squared(), (d - b).norm_squared()];
        if (first - second).abs() > AS_LONG * (first + second) {
            return first < second;
        }
        let before = |one: &Vector, other: &Vector| {
            let pairs = one.iter().zip(other).map(|(x, y)| x.total_cmp(y));
            pairs.fold(Ordering::Equal, Ordering::then)
        };
        let lowest = (0..4).min_by(|&i, &j| before(&corners[i], &corners[j]));
        lowest.is_some_and(|corner| corner % 2 == 0)
    }
}

impl VolumeMesh {
    /// The lowest and the highest corner of the box around the nodes of cells: others are no part of the tissue.
    pub fn bounds(&self) -> [Vector; 2] {
        let nodes = self.cells.iter().flat_map(|(_, nodes)| nodes);
        bounds_of(nodes.map(|&node| &self.nodes[node as usize])).unwrap_or_default()
    }

    /// For each node whether it belongs to a cell; others are no part of the tissue, and nothing holds or moves them.
    pub fn is_in_cell(&self) -> Vec<bool> {
        let mut is_in_cell = vec![false; self.nodes.len()];
        let nodes = self.cells.iter().flat_map(|(_, nodes)| nodes);
        nodes.for_each(|&node| is_in_cell[node as usize] = true);
        is_in_cell
    }

    /// The corner positions of a cell, as many as its shape has nodes.
    pub fn corners(&self, cell: usize) -> impl ExactSizeIterator<Item = Vector> + '_ {
        self.cells.nodes(cell).iter().map(|&node| self.nodes[node as usize])
    }

    /// The mean of the corners of a cell.
    pub fn centroid(&self, cell: usize) -> Vector {
        let corners = self.corners(cell);
        let count = corners.len() as f64;
        corners.sum::<Vector>() / count
    }

    /// The node set asked for as `NAME` or `set_NAME`.
    pub fn node_set(&self, name: &str) -> Option<&[u32]> {
        self.node_sets
            .get(name)
            .or_else(|| self.node_sets.get(name.strip_prefix("set_")?))
            .map(Vec::as_slice)
    }

    pub(super) fn face(&self, cell: u32, local: u8) -> BoundaryFace {
        let cell_nodes = self.cells.nodes(cell as usize);
        let face = self.cells.shape(cell as usize).faces()[local as usize];
        let nodes = std::array::from_fn(|corner| cell_nodes[face[corner % face.len()]]);
        BoundaryFace { cell, nodes, count: face.len() as u8 }
    }

    /// The faces as a triangle surface whose points are their nodes in ascending order.
    pub fn surface_of(&self, faces: &[BoundaryFace]) -> TriangleSurface {
        let mut node_ids: Vec<u32> = faces.iter().flat_map(|face| face.nodes()).copied().collect();
        node_ids.sort_unstable();
        node_ids.dedup();
        let mut point_of = vec![u32::MAX; self.nodes.len()];
        for (point, &node) in node_ids.iter().enumerate() {
            point_of[node as usize] = point as u32;
        }
        let triangles = faces
            .iter()
            .flat_map(|face| face.triangles(&self.nodes))
            .map(|triangle| triangle.map(|node| point_of[node as usize]))
            .collect();
        let points = node_ids.iter().map(|&node| self.nodes[node as usize]).collect();
        TriangleSurface { points, triangles, node_ids: Some(node_ids) }
    }
}
