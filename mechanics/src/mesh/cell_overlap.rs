//! Depth of overlap of a meshed boundary: its nodes that lie in cells which are not theirs.
//!
//! The depth of such a node is its way out through the tissue that it lies in: cells are visited from that which it is in, the nearest
//! first, up to the closest place of their boundary. Tissue around the node itself is not taken for that unless it is connected within
//! this distance, and a node outside of all cells has no depth, however oddly triangles cross around it.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;
use rayon::prelude::*;

use super::bounds::{parry_box, to_parry};
use super::{Cells, TriangleSurface, Vector, bounds_of};
use crate::rows::Rows;

/// Distances that differ by less than this part are one.
const ROUNDING: f64 = 1e-9;

/// The node that lies deepest in cells that are not its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// In mm.
    pub depth: f64,
    pub at: Vector,
}

/// The deepest overlap of cells whose nodes are at `positions`, in mm, and whose boundary is a surface with the numbers of nodes as
/// those of its points. Positions have to be finite.
pub fn deepest_overlap(
    cells: &Cells,
    positions: &[Vector],
    boundary: &TriangleSurface,
) -> Option<Overlap> {
    let node_of = boundary.node_ids.as_ref()?;
    let boxes: Vec<_> = boundary.points.iter().map(|at| parry_box([*at, *at])).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let strangers = |cell: usize| -> Vec<(u32, u32)> {
        let nodes = cells.nodes(cell);
        let corners = || nodes.iter().map(|&node| &positions[node as usize]);
        let Some(around) = bounds_of(corners()).map(parry_box) else { return Vec::new() };
        let is_inside = |&point: &u32| {
            !nodes.contains(&node_of[point as usize])
                && contains(cells, cell, positions, &boundary.points[point as usize])
        };
        tree.intersect_aabb(&around).filter(is_inside).map(|point| (point, cell as u32)).collect()
    };
    let mut inside: Vec<(u32, u32)> =
        (0..cells.len()).into_par_iter().flat_map_iter(strangers).collect();
    if inside.is_empty() {
        return None;
    }
    inside.sort_unstable();
    let ways = WaysOut::new(cells, positions, boundary, node_of);
    let depth = |&(point, stranger): &(u32, u32)| {
        let depth = ways.shortest(point, stranger)?;
        Some(Overlap { depth, at: boundary.points[point as usize] })
    };
    let found: Vec<Overlap> = inside.par_iter().filter_map(depth).collect();
    found.into_iter().max_by(|one, other| one.depth.total_cmp(&other.depth))
}

/// Cells and their boundary, from node to node.
struct WaysOut<'a> {
    cells: &'a Cells,
    positions: &'a [Vector],
    boundary: &'a TriangleSurface,
    node_of: &'a [u32],
    /// The cells around each node.
    around: Rows<u32>,
    /// The triangles of the boundary around each node.
    fans: Rows<u32>,
}

/// A cell that is to be visited, the nearest first.
#[derive(PartialEq)]
struct Ahead {
    squared_distance: f64,
    cell: u32,
}

impl Eq for Ahead {}

impl Ord for Ahead {
    fn cmp(&self, other: &Self) -> Ordering {
        let nearer = other.squared_distance.total_cmp(&self.squared_distance);
        nearer.then(other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Ahead {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<'a> WaysOut<'a> {
    fn new(
        cells: &'a Cells,
        positions: &'a [Vector],
        boundary: &'a TriangleSurface,
        node_of: &'a [u32],
    ) -> Self {
        let mut corners = Rows::default();
        for triangle in &boundary.triangles {
            corners.push(triangle.map(|corner| node_of[corner as usize]));
        }
        let (around, fans) = (cells.around(positions.len()), corners.inverted(positions.len()));
        WaysOut { cells, positions, boundary, node_of, around, fans }
    }

    /// From a point of the boundary in a cell, in mm; none where it lies in front of the boundary after all, as beside a face that is
    /// not flat.
    fn shortest(&self, point: u32, first: u32) -> Option<f64> {
        let at = &self.boundary.points[point as usize];
        let (mut shortest, mut is_behind) = (f64::INFINITY, false);
        let mut seen = BTreeSet::from([first]);
        let mut ahead = BinaryHeap::from([Ahead { squared_distance: 0.0, cell: first }]);
        while let Some(Ahead { squared_distance, cell }) = ahead.pop() {
            if squared_distance >= shortest * shortest {
                break;
            }
            let nodes = self.cells.nodes(cell as usize);
            let triangles = nodes.iter().flat_map(|&node| self.fans.row(node as usize));
            for &triangle in triangles {
                let (distance, behind) = self.distance(at, triangle, (point, nodes));
                // At an edge it is behind one of both.
                if distance < shortest * (1.0 - ROUNDING) {
                    (shortest, is_behind) = (distance, behind);
                } else if distance <= shortest * (1.0 + ROUNDING) {
                    is_behind |= behind;
                }
            }
            for &next in nodes.iter().flat_map(|&node| self.around.row(node as usize)) {
                if seen.insert(next) {
                    let squared_distance = self.squared_distance(at, next);
                    ahead.push(Ahead { squared_distance, cell: next });
                }
            }
        }
        is_behind.then_some(shortest)
    }

    /// From a triangle of the boundary that is of a cell, but not around the point; and whether the point is behind it.
    fn distance(&self, at: &Vector, triangle: u32, (point, nodes): (u32, &[u32])) -> (f64, bool) {
        let corners = &self.boundary.triangles[triangle as usize];
        let is_of_cell = corners.iter().all(|&own| nodes.contains(&self.node_of[own as usize]));
        if !is_of_cell || corners.contains(&point) {
            return (f64::INFINITY, false);
        }
        let triangle = triangle as usize;
        let places = self.boundary.corners(triangle).map(|own| own - at);
        let is_behind = self.boundary.area_vector(triangle).dot(&places[0]) > 0.0;
        let [a, b, c] = places.map(|own| to_parry(&own));
        let distance = Triangle::new(a, b, c).distance_to_local_point(ParryVector::ZERO, true);
        (distance, is_behind)
    }

    /// From the box around a cell.
    fn squared_distance(&self, at: &Vector, cell: u32) -> f64 {
        let corners = self.cells.nodes(cell as usize).iter();
        let bounds = bounds_of(corners.map(|&node| &self.positions[node as usize]));
        bounds.map_or(f64::INFINITY, |[low, high]| {
            (low - at).sup(&(at - high)).sup(&Vector::zeros()).norm_squared()
        })
    }
}

/// Whether a point lies in a cell: in one of the tetrahedra between the middle of the cell and the triangles of its faces.
fn contains(cells: &Cells, cell: usize, positions: &[Vector], at: &Vector) -> bool {
    let corners = || cells.nodes(cell).iter().map(|&node| positions[node as usize]);
    let middle = corners().sum::<Vector>() / cells.nodes(cell).len() as f64;
    let corner = |local: usize| positions[cells.nodes(cell)[local] as usize];
    let triangles = cells.shape(cell).faces().iter().flat_map(|face| {
        (1..face.len() - 1).map(move |k| [face[0], face[k], face[k + 1]].map(corner))
    });
    // The corners of a face are counter-clockwise from outside.
    let volume = |a: Vector, b: Vector, c: Vector| a.dot(&b.cross(&c));
    triangles.into_iter().any(|[a, b, c]| {
        let sides = [[a, b, c], [*at, b, c], [a, *at, c], [a, b, *at]];
        let [whole, of_a, of_b, of_c] =
            sides.map(|[a, b, c]| volume(a - middle, b - middle, c - middle));
        whole > 0.0 && of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0 && of_a + of_b + of_c <= whole
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{CellShape, VolumeMesh};

    /// Hexahedra with corners of their own or shared ones, each given by its lower and its upper four.
    fn overlap(nodes: &[[f64; 3]], hexahedra: &[[u32; 8]]) -> Option<Overlap> {
        let mut cells = Cells::default();
        hexahedra.iter().for_each(|nodes| cells.push(CellShape::Hex8, nodes));
        let nodes = nodes.iter().map(|&[x, y, z]| Vector::new(x, y, z)).collect();
        let mesh = VolumeMesh { nodes, cells, ..VolumeMesh::default() };
        let boundary = mesh.surface_of(&mesh.boundary_faces());
        deepest_overlap(&mesh.cells, &mesh.nodes, &boundary)
    }

    fn rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) -> [[f64; 3]; 4] {
        [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]
    }

    /// A block of 10 mm, and one of 4 mm whose bottom is at a height.
    fn blocks(height: f64) -> Option<Overlap> {
        let (wide, narrow) = ([0.0, 10.0], [3.0, 7.0]);
        let nodes = [
            rectangle(wide, wide, 0.0),
            rectangle(wide, wide, 10.0),
            rectangle(narrow, narrow, height),
            rectangle(narrow, narrow, height + 4.0),
        ];
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]];
        overlap(nodes.as_flattened(), &cells)
    }

    #[test]
    fn a_block_lies_as_deep_in_another_as_its_lower_corners() {
        let found = blocks(9.7).unwrap();
        assert!((found.depth - 0.3).abs() < 1e-12 && found.at.z == 9.7, "{found:?}");
        assert_eq!(blocks(10.1), None);
        assert!(blocks(10.0).is_none_or(|own| own.depth < 1e-12));
    }

    #[test]
    fn a_fold_lies_as_deep_in_its_own_body_as_the_surface_that_it_faces() {
        // A C whose upper arm reaches half a millimetre into the lower one.
        let (whole, narrow) = ([0.0, 10.0], [1.0, 9.0]);
        let mut nodes = Vec::new();
        for z in [0.0, 2.0, 4.0, 6.0] {
            nodes.extend(rectangle([0.0, 2.0], whole, z));
        }
        // The ends of the arms.
        for [x, z] in [[12.0, 0.0], [12.0, 2.0]] {
            nodes.extend([[x, 0.0, z], [x, 10.0, z]]);
        }
        for [x, z] in [[11.0, 1.5], [11.0, 6.0]] {
            nodes.extend(narrow.map(|y| [x, y, z]));
        }
        let column = |k: u32| std::array::from_fn(|corner| 4 * k + corner as u32);
        let arm = |k: u32, end: u32| {
            let (low, high) = (4 * k, 4 * k + 4);
            [low + 1, end, end + 1, low + 2, high + 1, end + 2, end + 3, high + 2]
        };
        let cells = [column(0), column(1), column(2), arm(0, 16), arm(2, 20)];
        let found = overlap(&nodes, &cells).unwrap();
        assert!((found.depth - 0.5).abs() < 1e-12 && found.at.x == 11.0, "{found:?}");
    }
}
