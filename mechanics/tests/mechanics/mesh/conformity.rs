//! Cells that do not match face to face.

use mechanics::mesh::conformity::cells_do_not_match;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};

use crate::scenes::join;

/// A block of 20 mm and one beside it, with the nodes of both at one place made one where that is wanted.
fn beside(
    (shape, cells): (CellShape, [usize; 3]),
    (other_shape, other_cells): (CellShape, [usize; 3]),
    is_one: impl Fn(&Vector) -> bool,
) -> VolumeMesh {
    let mut mesh = block(Vector::repeat(20.0), cells, shape);
    let mut other = block(Vector::repeat(20.0), other_cells, other_shape);
    other.nodes.iter_mut().for_each(|x| x.x += 20.0);
    join(&mut mesh, &other, is_one);
    mesh
}

fn told(mesh: &VolumeMesh) -> Option<f64> {
    let warning = cells_do_not_match(mesh, &mesh.boundary_faces())?;
    assert_eq!(warning.code, "cells-do-not-match");
    warning.numbers.iter().find(|(name, _)| **name == *"count").map(|(_, count)| *count)
}

#[test]
fn cells_that_share_whole_faces_match_and_those_of_other_sizes_or_cuts_do_not() {
    let (hex, wedge, tet) = (CellShape::Hex8, CellShape::Wedge6, CellShape::Tet4);
    let everywhere = |_: &Vector| true;
    for (one, other) in [
        ((hex, [2; 3]), (hex, [2; 3])),
        ((hex, [2; 3]), (wedge, [2; 3])),
        ((tet, [2; 3]), (tet, [2; 3])),
    ] {
        assert_eq!(told(&beside(one, other, everywhere)), None, "{one:?} {other:?}");
    }
    for (one, other) in [
        ((hex, [2; 3]), (hex, [4; 3])),
        ((tet, [2; 3]), (tet, [4; 3])),
        ((hex, [2; 3]), (tet, [2; 3])),
        ((tet, [2; 3]), (wedge, [2; 3])),
    ] {
        let count = told(&beside(one, other, everywhere));
        assert!(count.is_some_and(|count| count >= 8.0), "{one:?} {other:?}: {count:?}");
    }
}

#[test]
fn a_slit_with_nodes_of_its_own_and_parts_that_share_no_node_are_meant() {
    let (hex, tet) = ((CellShape::Hex8, [3; 3]), (CellShape::Tet4, [3; 3]));
    for shape in [hex, tet] {
        assert_eq!(told(&beside(shape, shape, |x| x.z < 10.0)), None, "a slit of {shape:?}");
        let corner = |x: &Vector| x.z < 10.0 || x.y < 10.0;
        assert_eq!(told(&beside(shape, shape, corner)), None, "a slit of {shape:?} in a corner");
    }
    assert_eq!(told(&beside(hex, (CellShape::Hex8, [4; 3]), |_| false)), None);
    assert_eq!(told(&beside(hex, tet, |_| false)), None);
}
