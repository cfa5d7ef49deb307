//! Depth of overlap of a meshed boundary: its nodes that lie in cells which are not theirs.
//!
//! What such a node lies in is of another body, or of its own as where lips pass through each other. From another body
//! the way out is that to the closest place of its boundary; in its own it is that to the closest boundary which faces the node,
//! because its own surroundings are closer. A node outside of all cells has no depth, however oddly triangles cross around it.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{Cells, SurfaceSearch, TriangleSurface, Vector, bounds_of};

/// The node that lies deepest in cells that are not its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// In mm.
    pub depth: f64,
    pub at: Vector,
}

/// The deepest overlap of cells whose nodes are at `positions`, in mm, and whose boundary is a surface with the numbers of nodes as
/// those of its points. Positions have to be finite.
pub(super) fn deepest_overlap(
    cells: &Cells,
    positions: &[Vector],
    boundary: &TriangleSurface,
) -> Option<Overlap> {
    let node_of = boundary.node_ids.as_ref()?;
    let boxes: Vec<Aabb> = boundary.points.iter().map(|at| box_of(at, at)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let strangers = |cell: usize| -> Vec<(u32, u32)> {
        let nodes = cells.nodes(cell);
        let corners = || nodes.iter().map(|&node| &positions[node as usize]);
        let Some([low, high]) = bounds_of(corners()) else { return Vec::new() };
        let around = box_of(&low, &high);
        let is_inside = |&point: &u32| {
            !nodes.contains(&node_of[point as usize])
                && contains(cells, cell, positions, &boundary.points[point as usize])
        };
        tree.intersect_aabb(&around).filter(is_inside).map(|point| (point, nodes[0])).collect()
    };
    let mut inside: Vec<(u32, u32)> =
        (0..cells.len()).into_par_iter().flat_map_iter(strangers).collect();
    if inside.is_empty() {
        return None;
    }
    inside.sort_unstable();
    let mut bodies = DisjointSets::new(positions.len());
    for (_, nodes) in cells.iter() {
        nodes.iter().for_each(|&node| bodies.join(nodes[0], node));
    }
    let body_of: Vec<u32> = (0..positions.len() as u32).map(|node| bodies.root(node)).collect();
    let body = |point: u32| body_of[node_of[point as usize] as usize];
    let (search, normals) = (SurfaceSearch::new(boundary).ok()?, boundary.point_normals());
    let depth = |&(point, stranger): &(u32, u32)| {
        let (own, other) = (body(point), body_of[stranger as usize]);
        let at = boundary.points[point as usize];
        let counts = |triangle: usize| {
            let corners = &boundary.triangles[triangle];
            let normal = &normals[point as usize];
            body(corners[0]) == other
                && !corners.contains(&point)
                && (own != other || boundary.area_vector(triangle).dot(normal) < 0.0)
        };
        let closest = search.closest_where(&at, counts)?;
        let is_behind = (closest.point - at).dot(&search.pseudo_normal(&closest)) > 0.0;
        is_behind.then_some(Overlap { depth: closest.distance, at })
    };
    let found: Vec<Overlap> = inside.par_iter().filter_map(depth).collect();
    found.into_iter().max_by(|one, other| one.depth.total_cmp(&other.depth))
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

fn box_of(low: &Vector, high: &Vector) -> Aabb {
    let corner = |at: &Vector| ParryVector::new(at.x, at.y, at.z);
    Aabb::new(corner(low), corner(high))
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
