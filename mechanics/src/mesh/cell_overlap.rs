//! Depth of overlap of a meshed boundary: its nodes, and places of its edges, that lie in cells which are not theirs.
//!
//! The depth of such a place is its way out through the tissue that it lies in (`way_out`). No movement that parts the two is shorter;
//! where two ridges cross it may be longer, by the square root of two where both have right angles. A node outside of all cells has
//! no depth, however oddly triangles cross around it. Where boundaries pass through each other an edge of one lies in the other, also
//! where no node does: places between the edges are not looked at.

use std::cmp::Ordering;

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

use super::bounds::parry_box;
use super::cell_interior::{contains, part_inside};
use super::surface_edges::edges;
use super::way_out::{ROUNDING, WaysOut};
use super::{Cells, TriangleSurface, Vector, bounds_of};

/// Edges in cells whose deepest place is searched for, those with the deepest middles; and how often what is searched is cut by a
/// third.
const SEARCHED_EDGES: usize = 16;
const CUTS: usize = 20;

/// The place that lies deepest in cells that are not its own.
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
    let mesh = PlacedMesh { cells, positions, boundary, node_of: boundary.node_ids.as_ref()? };
    let (points, parts) = (mesh.points_inside(), mesh.edges_inside());
    if points.is_empty() && parts.is_empty() {
        return None;
    }
    let ways = WaysOut::new(cells, positions, boundary, mesh.node_of);
    let of_point = |&(point, stranger): &(u32, u32)| {
        let at = boundary.points[point as usize];
        Some(Overlap { depth: ways.shortest(&at, &[point], stranger)?, at })
    };
    let of_points: Vec<Overlap> = points.par_iter().filter_map(of_point).collect();
    let of_points = of_points.into_iter().max_by(by_depth);
    let of_edges = deepest_of_edges(boundary, &ways, &parts);
    let least = of_points.map_or(0.0, |own| own.depth * (1.0 + ROUNDING));
    of_edges.filter(|own| own.depth > least).or(of_points)
}

fn by_depth(one: &Overlap, other: &Overlap) -> Ordering {
    one.depth.total_cmp(&other.depth)
}

/// Cells and their boundary.
struct PlacedMesh<'a> {
    cells: &'a Cells,
    positions: &'a [Vector],
    boundary: &'a TriangleSurface,
    node_of: &'a [u32],
}

/// The part of an edge of the boundary that lies in a cell.
struct EdgeInside {
    edge: [u32; 2],
    cell: u32,
    /// From the one and to the other, as parts of the way from the first to the second point.
    part: [f64; 2],
}

impl PlacedMesh<'_> {
    /// Points of the boundary with the cells that they lie in and are not of, ascending.
    fn points_inside(&self) -> Vec<(u32, u32)> {
        let points = &self.boundary.points;
        let boxes = points.iter().map(|at| parry_box([*at, *at])).collect();
        let mut inside = self.in_cells(boxes, |cell, point| {
            let is_own = self.is_of(cell, point);
            let is_inside =
                !is_own && contains(self.cells, cell, self.positions, &points[point as usize]);
            is_inside.then_some((point, cell as u32))
        });
        inside.sort_unstable();
        inside
    }

    /// Edges of the boundary in the cells that neither of their points is of.
    fn edges_inside(&self) -> Vec<EdgeInside> {
        let sides = self.boundary.sorted_sides();
        let edges: Vec<[u32; 2]> = edges(&sides).map(|edge| edge[0].points).collect();
        let ends = |edge: [u32; 2]| edge.map(|point| &self.boundary.points[point as usize]);
        let boxes = edges.iter().map(|&edge| {
            let [from, to] = ends(edge);
            parry_box([from.inf(to), from.sup(to)])
        });
        self.in_cells(boxes.collect(), |cell, number| {
            let edge = edges[number as usize];
            if edge.iter().any(|&point| self.is_of(cell, point)) {
                return None;
            }
            let part = part_inside(self.cells, cell, self.positions, ends(edge))?;
            Some(EdgeInside { edge, cell: cell as u32, part })
        })
    }

    fn is_of(&self, cell: usize, point: u32) -> bool {
        self.cells.nodes(cell).contains(&self.node_of[point as usize])
    }

    /// What is found of each cell and each box that meets the box around it, by the number of the cell and of the box.
    fn in_cells<T: Send>(
        &self,
        boxes: Vec<Aabb>,
        found: impl Fn(usize, u32) -> Option<T> + Sync,
    ) -> Vec<T> {
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let of_cell = |cell: usize| -> Vec<T> {
            let corners = self.cells.nodes(cell).iter();
            let bounds = bounds_of(corners.map(|&node| &self.positions[node as usize]));
            let Some(around) = bounds.map(parry_box) else { return Vec::new() };
            tree.intersect_aabb(&around).filter_map(|number| found(cell, number)).collect()
        };
        (0..self.cells.len()).into_par_iter().flat_map_iter(of_cell).collect()
    }
}

/// The deepest place of edges that lie in cells: the deepest middle of what lies in a cell, and how much deeper it is beside that.
fn deepest_of_edges(
    boundary: &TriangleSurface,
    ways: &WaysOut,
    parts: &[EdgeInside],
) -> Option<Overlap> {
    let overlap_at = |EdgeInside { edge, cell, .. }: &EdgeInside, along: f64| {
        let [from, to] = edge.map(|point| boundary.points[point as usize]);
        let at = from + (to - from) * along;
        Overlap { depth: ways.shortest(&at, edge, *cell).unwrap_or(0.0), at }
    };
    let middle = |own: &EdgeInside| overlap_at(own, 0.5 * (own.part[0] + own.part[1]));
    let middles: Vec<Overlap> = parts.par_iter().map(middle).collect();
    let mut deepest: Vec<(Overlap, &EdgeInside)> = middles.into_iter().zip(parts).collect();
    deepest.sort_by(|(one, _), (other, _)| by_depth(other, one));
    deepest.truncate(SEARCHED_EDGES);
    let searched = |(mut best, own): (Overlap, &EdgeInside)| {
        let [mut low, mut high] = own.part;
        for _ in 0..CUTS {
            let third = (high - low) / 3.0;
            let [near, far] = [low + third, high - third];
            let [at_near, at_far] = [near, far].map(|along| overlap_at(own, along));
            [low, high] = if at_near.depth < at_far.depth { [near, high] } else { [low, far] };
            best = [best, at_near, at_far].into_iter().max_by(by_depth).unwrap_or(best);
        }
        best
    };
    let found: Vec<Overlap> = deepest.into_par_iter().map(searched).collect();
    found.into_iter().max_by(by_depth).filter(|own| own.depth > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::sample::block;
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

    /// A prism of a length along one axis, each of whose ends is a quadrangle in the two next axes, counter-clockwise.
    fn prism(axis: usize, [from, to]: [f64; 2], section: [[f64; 2]; 4]) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| {
            let mut at = [0.0; 3];
            at[axis] = if corner < 4 { from } else { to };
            [at[(axis + 1) % 3], at[(axis + 2) % 3]] = section[corner % 4];
            at
        })
    }

    fn of_two(one: [[f64; 3]; 8], other: [[f64; 3]; 8]) -> Option<Overlap> {
        overlap(
            [one, other].as_flattened(),
            &[[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]],
        )
    }

    /// A block of 10 mm under a bar that reaches beyond it on both sides, so that no corner of one lies in the other.
    fn bar_on_block(section: [[f64; 2]; 4]) -> Option<Overlap> {
        let block = prism(2, [0.0, 10.0], [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
        of_two(block, prism(1, [-5.0, 15.0], section))
    }

    #[test]
    fn a_bar_lies_as_deep_in_a_block_as_the_edges_that_pass_through_it() {
        // By z and x: flat, and turned onto an edge.
        let flat = |z: f64| bar_on_block([[z, 3.0], [z + 4.0, 3.0], [z + 4.0, 7.0], [z, 7.0]]);
        let turned =
            |z: f64| bar_on_block([[z, 5.0], [z + 2.0, 3.0], [z + 4.0, 5.0], [z + 2.0, 7.0]]);
        for found in [flat(9.7), turned(9.7)] {
            let Overlap { depth, at } = found.unwrap();
            assert!((depth - 0.3).abs() < 1e-12, "{found:?}");
            let [x, y, z] = at.into();
            assert!((3.0..=7.0).contains(&x) && (0.0..=10.0).contains(&y), "{found:?}");
            assert!((9.7..=10.0).contains(&z), "{found:?}");
        }
        for found in [flat(10.0), turned(10.0)] {
            assert!(found.is_none_or(|own| own.depth < 1e-12), "{found:?}");
        }
        assert_eq!([flat(10.1), turned(10.1)], [None, None]);
    }

    #[test]
    fn ridges_that_cross_lie_as_deep_as_the_deepest_place_of_either_is_behind_the_faces_of_the_other()
     {
        let crossed = |one: [[f64; 2]; 4], other: [[f64; 2]; 4]| {
            let length = [-10.0, 10.0];
            of_two(prism(0, length, one), prism(1, length, other)).unwrap()
        };
        // By y and z, by z and x: squares on an edge, .3 mm in each other.
        let found = crossed(
            [[5.0, 5.0], [0.0, 10.0], [-5.0, 5.0], [0.0, 0.0]],
            [[19.7, 0.0], [14.7, 5.0], [9.7, 0.0], [14.7, -5.0]],
        );
        assert!((found.depth - 0.3 / 2.0_f64.sqrt()).abs() < 1e-12, "{found:?}");
        // One face steeper than the other: y + 10 - z to the one, over the root of 2, is 10 - z - 2 y to the other, over that of 5.
        let found = crossed(
            [[5.0, 0.0], [0.0, 10.0], [-5.0, 5.0], [0.0, 0.0]],
            [[19.7, 0.0], [19.7, 5.0], [9.7, 0.0], [14.7, -5.0]],
        );
        let (even, steep) = (0.5_f64.sqrt(), 0.2_f64.sqrt());
        let aside = -0.3 * (even - steep) / (even + 2.0 * steep);
        let depth = (0.3 + aside) * even;
        assert!((found.depth - depth).abs() < 1e-4, "{found:?} {depth}");
    }

    #[test]
    fn cells_of_one_block_do_not_lie_in_each_other() {
        for shape in [CellShape::Hex8, CellShape::Tet4, CellShape::Wedge6] {
            let mut mesh = block(Vector::new(6.0, 5.0, 4.0), [4, 3, 3], shape);
            for node in &mut mesh.nodes {
                *node += 0.2 * Vector::new(node.y.sin(), node.z.sin(), (node.x + node.y).sin());
            }
            let boundary = mesh.surface_of(&mesh.boundary_faces());
            let found = deepest_overlap(&mesh.cells, &mesh.nodes, &boundary);
            assert!(found.is_none_or(|own| own.depth < 1e-9), "{shape:?} {found:?}");
        }
    }
}
