//! The report on an uploaded mesh.

use mechanics::mesh::check::{MeshReport, several_components, units_suspect};
use mechanics::mesh::connectivity::Faces;
use mechanics::mesh::duplicate_cells::{cells_of_two_shapes, duplicate_cells};
use mechanics::mesh::{CellShape, TriangleSurface, Vector, sample};

use crate::samples::{closed_surface, mixed_mesh};

#[test]
fn a_volume_report_counts_cells_sets_and_labels() {
    let report = MeshReport::of_volume(&mixed_mesh());
    assert_eq!((report.nodes, report.components), (11, 1));
    assert_eq!(report.cells, [("hex8", 1), ("tet4", 1), ("wedge6", 1)].into());
    assert_eq!(report.node_sets["jaw attached"], 4);
    assert_eq!(report.cell_sets["muscle"], 2);
    assert_eq!(report.node_labels["tag"][&1], 4);
    assert_eq!(report.cell_labels["band"], [(-7, 1), (0, 1), (1, 1)].into());
    let codes: Vec<&str> = report.warnings.iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["empty-sets"]);
}

#[test]
fn volume_and_area_are_those_of_the_shape() {
    let mut mesh = mixed_mesh();
    mesh.nodes[6].z = 70.0;
    mesh.nodes[8].z = 120.0;
    let report = MeshReport::of_volume(&mesh);
    // A box, half a box of 50 mm on it, and a tetrahedron: base 90 x 60 / 2 less 1 mm of tilt.
    let tetrahedron = mesh.cell_jacobian(2).gauss_min / 6.0;
    let expected = 90.0 * 80.0 * 70.0 + 90.0 * 80.0 * 50.0 / 2.0 + tetrahedron;
    assert!((report.volume_mm3.unwrap() - expected).abs() < 1e-9 * expected);
    let closed = MeshReport::of_surface(&closed_surface());
    let sixth = 100.0 * 100.0 * (100.0 / 3.0) / 6.0;
    assert!((closed.volume_mm3.unwrap() - sixth).abs() < 1e-9 * sixth);
    assert_eq!((closed.open_edges, closed.nonmanifold_edges), (0, 0));
}

#[test]
fn open_nonmanifold_and_separate_parts_are_counted() {
    let mut skin = closed_surface();
    skin.triangles.pop();
    skin.points.push(Vector::new(50.0, 50.0, 50.0));
    skin.triangles.push([0, 1, 4]);
    let moved: Vec<Vector> = skin.points.iter().map(|p| p + Vector::x() * 500.0).collect();
    let triangles = [[5, 6, 7], [5, 7, 8]];
    let skin = TriangleSurface {
        points: skin.points.into_iter().chain(moved).collect(),
        triangles: skin.triangles.into_iter().chain(triangles).collect(),
        node_ids: None,
    };
    let report = MeshReport::of_surface(&skin);
    assert_eq!(report.nonmanifold_edges, 1);
    assert_eq!(report.open_edges, 3 + 2 + 4);
    assert_eq!((report.components, report.largest_components.clone()), (2, vec![4, 2]));
    assert_eq!((report.unreferenced_nodes, report.duplicate_nodes), (1, 0));
    assert_eq!(report.volume_mm3, None);
}

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
fn a_face_of_three_cells_is_reported() {
    let mut mesh = mixed_mesh();
    mesh.nodes.push(Vector::new(45.0, -60.0, 200.0));
    mesh.cells.push(CellShape::Tet4, &[4, 11, 5, 8]);
    mesh.nodes.push(mesh.nodes[3]);
    let report = MeshReport::of_volume(&mesh);
    assert_eq!((report.nonmanifold_faces, report.duplicate_nodes), (1, 1));
}

#[test]
fn a_face_in_metres_is_suspected_and_the_factor_named() {
    assert_eq!(units_suspect(250.0), None);
    let metres = units_suspect(0.25).unwrap();
    assert_eq!(metres.code, "units-suspect");
    assert!(metres.numbers.contains(&("suggested_factor", 1000.0)));
    let micrometres = units_suspect(250_000.0).unwrap();
    assert!(micrometres.numbers.contains(&("suggested_factor", 0.001)));
    assert_eq!(units_suspect(1e9).unwrap().numbers.len(), 1);
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
