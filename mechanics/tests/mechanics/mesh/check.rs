//! Cells that stand twice in a mesh, and parts of it that hang together nowhere.

use mechanics::mesh::check::several_components;
use mechanics::mesh::connectivity::Faces;
use mechanics::mesh::duplicate_cells::{cells_of_two_shapes, duplicate_cells};
use mechanics::mesh::{CellShape, Vector, sample};

use crate::samples::mixed_mesh;

#[test]
fn cells_that_stand_twice_are_reported_with_the_first_of_them() {
    let mut mesh = mixed_mesh();
    assert_eq!(duplicate_cells(&mesh), None);
    let (shape, first) = mesh.cells.iter().next().map(|(s, nodes)| (s, nodes.to_vec())).unwrap();
    // Other cells at the same two lowest nodes are no copies; the same nodes in another order are.
    let turned: Vec<u32> = [&first[1..3], &first[..1], &first[3..]].concat();
    let count = mesh.cells.len();
    mesh.cells.push(shape, &turned);
    mesh.cells.push(shape, &first);
    let told = duplicate_cells(&mesh).unwrap();
    assert_eq!(told.code, "duplicate-cells");
    assert_eq!(told.numbers, [("count", 2.0), ("first_cell", count as f64)]);
}

/// Tetrahedra around the diagonal from the first to the seventh corner of a hexahedron.
const IN_HEXAHEDRON: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

#[test]
fn cells_that_stand_in_a_cell_of_another_shape_are_reported_and_those_beside_it_are_not() {
    let size = Vector::new(3.0, 2.0, 2.0);
    let mut mesh = sample::block(size, [3, 2, 2], CellShape::Hex8);
    // A tetrahedron on each side of a face, with the other diagonal than its neighbour, and one in a warped face.
    let corners = mesh.cells.nodes(2).to_vec();
    for (apex, [a, b, c]) in [(4.0, [1, 2, 6]), (4.5, [1, 2, 5])] {
        mesh.nodes.push(Vector::new(apex, 0.5, 0.5));
        let apex = mesh.nodes.len() as u32 - 1;
        mesh.cells.push(CellShape::Tet4, &[corners[a], corners[b], corners[c], apex]);
    }
    mesh.cells.push(CellShape::Tet4, &[corners[1], corners[2], corners[6], corners[5]]);
    assert_eq!(cells_of_two_shapes(&mesh), None);
    assert_eq!(cells_of_two_shapes(&mixed_mesh()), None);
    let first = mesh.cells.len() as f64;
    for cell in [1, 4] {
        let corners = mesh.cells.nodes(cell).to_vec();
        for nodes in IN_HEXAHEDRON.map(|nodes| nodes.map(|local| corners[local])) {
            mesh.cells.push(CellShape::Tet4, &nodes);
        }
    }
    let told = cells_of_two_shapes(&mesh).unwrap();
    let expected = [("count", 12.0), ("first_cell", first), ("other_cell", 1.0)];
    assert_eq!((told.code, &told.numbers[..]), ("duplicate-cells", &expected[..]));
    // The two wedges of a hexahedron.
    let mut mesh = sample::block(size, [3, 2, 2], CellShape::Hex8);
    let corners = mesh.cells.nodes(5).to_vec();
    for nodes in [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]] {
        mesh.cells.push(CellShape::Wedge6, &nodes.map(|local: usize| corners[local]));
    }
    let told = cells_of_two_shapes(&mesh).unwrap();
    assert_eq!(told.numbers, [("count", 2.0), ("first_cell", 12.0), ("other_cell", 5.0)]);
    assert_eq!(duplicate_cells(&mesh), None);
}

#[test]
fn parts_that_share_no_node_are_reported_and_those_that_touch_in_one_are_not() {
    let told = |shared: usize| {
        let mut mesh = sample::block(Vector::new(1.0, 1.0, 1.0), [2, 2, 2], CellShape::Tet4);
        let first: Vec<u32> = mesh.cells.nodes(0).to_vec();
        let mut cell = first[..shared].to_vec();
        while cell.len() < 4 {
            mesh.nodes.push(Vector::new(3.0, cell.len() as f64, (cell.len() * cell.len()) as f64));
            cell.push(mesh.nodes.len() as u32 - 1);
        }
        mesh.cells.push(CellShape::Tet4, &cell);
        several_components(&mesh, &Faces::new(&mesh))
    };
    let warning = told(0).unwrap();
    assert_eq!(warning.code, "several-components");
    assert_eq!(warning.numbers, [("count", 1.0), ("cells", 1.0)]);
    assert_eq!((told(1), told(2)), (None, None));
}
