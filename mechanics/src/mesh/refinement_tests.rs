use super::*;
use crate::mesh::sample::{ThickSphere, block, thick_sphere_octant};

const SHAPES: [CellShape; 3] = [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6];

/// The volume by Gauss's theorem; exact for flat faces.
fn volumes(mesh: &VolumeMesh) -> Vec<f64> {
    mesh.cells
        .iter()
        .map(|(shape, nodes)| {
            let mut volume = 0.0;
            for face in shape.faces() {
                let at = |local: usize| mesh.nodes[nodes[face[local]] as usize];
                for corner in 2..face.len() {
                    volume += at(0).cross(&at(corner - 1)).dot(&at(corner)) / 6.0;
                }
            }
            volume
        })
        .collect()
}

/// A hexahedron with a wedge beside it and a tetrahedron on the wedge's end.
fn mixed() -> VolumeMesh {
    let mut mesh = block(Vector::new(1.0, 2.0, 1.0), [1, 2, 1], CellShape::Hex8);
    let mut cells = Cells::default();
    cells.push(CellShape::Hex8, mesh.cells.nodes(0));
    let hexahedron = mesh.cells.nodes(1);
    let [a, b, c, e, f, g] = [0, 1, 2, 4, 5, 6].map(|local| hexahedron[local]);
    cells.push(CellShape::Wedge6, &[a, b, c, e, f, g]);
    mesh.nodes.push(Vector::new(0.8, 1.4, 2.0));
    let tip = mesh.nodes.len() as u32 - 1;
    cells.push(CellShape::Tet4, &[e, f, g, tip]);
    mesh.cells = cells;
    mesh
}

fn twisted(mut mesh: VolumeMesh) -> VolumeMesh {
    for node in &mut mesh.nodes {
        *node += Vector::new(0.1 * node.y * node.z, 0.07 * node.x * node.z, 0.05 * node.x);
    }
    mesh
}

#[test]
fn refinement_keeps_volume_and_orientation() {
    for mesh in SHAPES
        .map(|shape| block(Vector::new(3.0, 2.0, 1.0), [3, 2, 2], shape))
        .into_iter()
        .chain([mixed(), twisted(block(Vector::new(3.0, 2.0, 1.0), [2; 3], CellShape::Tet4))])
    {
        let fine = refine(&mesh);
        let [before, after] = [&mesh, &fine].map(volumes);
        assert_eq!(after.len(), 8 * before.len());
        assert!(after.iter().all(|&volume| volume > 0.0));
        let [before, after] = [before, after].map(|v| v.iter().sum::<f64>());
        // Rounding only: the faces are flat.
        assert!((after - before).abs() < 1e-12 * before);
    }
}

#[test]
fn refined_cells_share_whole_faces() {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 2, cells_along: 3 };
    let meshes =
        SHAPES.map(|shape| thick_sphere_octant(sphere, shape)).into_iter().chain([mixed()]);
    for mesh in meshes {
        let fine = refine(&mesh);
        let [coarse_faces, fine_faces] = [&mesh, &fine].map(VolumeMesh::boundary_faces);
        assert_eq!(fine_faces.len(), 4 * coarse_faces.len());
        let outside = fine.surface_of(&fine_faces);
        assert_eq!(2 * outside.points.len(), outside.triangles.len() + 4);
    }
    let (mesh, fine) = (mixed(), refine(&mixed()));
    let area = |mesh: &VolumeMesh| mesh.surface_of(&mesh.boundary_faces()).area();
    assert!((area(&mesh) - area(&fine)).abs() < 1e-12 * area(&mesh));
}

#[test]
fn a_refined_block_has_the_nodes_and_sets_of_the_finer_block() {
    for shape in SHAPES {
        let size = Vector::new(3.0, 2.0, 4.0);
        let fine = refine(&block(size, [3, 2, 1], shape));
        let expected = block(size, [6, 4, 2], shape);
        assert_eq!(fine.nodes.len(), 7 * 5 * 3);
        let place = |mesh: &VolumeMesh, node: u32| {
            let p = mesh.nodes[node as usize];
            [p.x, p.y, p.z].map(|x| (x * 12.0).round() as i64)
        };
        for (name, set) in &expected.node_sets {
            let places = |mesh: &VolumeMesh, set: &[u32]| {
                let mut places: Vec<_> = set.iter().map(|&node| place(mesh, node)).collect();
                places.sort_unstable();
                places
            };
            assert!(fine.node_sets[name].is_sorted());
            assert_eq!(places(&fine, &fine.node_sets[name]), places(&expected, set));
        }
    }
}

#[test]
fn walls_one_cell_apart_do_not_grow_together() {
    for shape in SHAPES {
        let mut mesh = block(Vector::new(4.0, 4.0, 1.0), [4, 4, 1], shape);
        let walls = [mesh.node_sets["z_min"].clone(), mesh.node_sets["z_max"].clone()].concat();
        mesh.node_labels = BTreeMap::from([("wall".into(), vec![7; mesh.nodes.len()])]);
        mesh.node_sets.insert("walls".into(), walls);
        let fine = refine(&mesh);
        let inside = |node: &usize| {
            let p = fine.nodes[*node];
            p.z == 0.5 && p.x > 0.0 && p.x < 4.0 && p.y > 0.0 && p.y < 4.0
        };
        let set = &fine.node_sets["walls"];
        assert!(!set.iter().any(|&node| inside(&(node as usize))), "{shape:?}");
        let labels = &fine.node_labels["wall"];
        assert!((0..fine.nodes.len()).all(|n| labels[n] == if inside(&n) { 6 } else { 7 }));
    }
}

#[test]
fn cells_inherit_labels_and_nodes_average_vectors() {
    let mut mesh = block(Vector::new(2.0, 1.0, 1.0), [2, 1, 1], CellShape::Hex8);
    mesh.cell_labels.insert("region".into(), vec![3, 5]);
    mesh.cell_sets.insert("right".into(), vec![1]);
    mesh.node_vectors.insert("u".into(), mesh.nodes.clone());
    mesh.cell_vectors.insert("fibre".into(), vec![Vector::x(), Vector::z()]);
    let fine = refine(&mesh);
    assert_eq!(fine.cell_vectors["fibre"], [[Vector::x(); 8], [Vector::z(); 8]].concat());
    assert_eq!(fine.cell_labels["region"], [[3; 8], [5; 8]].concat());
    assert_eq!(fine.cell_sets["right"], (8..16).collect::<Vec<u32>>());
    assert_eq!(fine.node_vectors["u"], fine.nodes);
    for &cell in &fine.cell_sets["right"] {
        assert!(fine.corners(cell as usize).all(|p| p.x >= 1.0));
    }
}

#[test]
fn a_tetrahedron_is_cut_along_its_shortest_diagonal() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
    // The diagonals of the inner octahedron measure 1.12, 1.12 and, from the middle of edge 0-3
    // to that of edge 1-2, 0.5 mm. Renaming corners, evenly, gives each diagonal its turn.
    for [b, c, d] in [[1, 2, 3], [2, 3, 1], [3, 1, 2]] {
        let mut mesh = VolumeMesh {
            nodes: [0, b, c, d].map(|node| Vector::from(positions[node])).to_vec(),
            ..VolumeMesh::default()
        };
        mesh.cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
        let fine = refine(&mesh);
        assert!(volumes(&fine).iter().all(|&volume| volume > 0.0));
        let ends = [Vector::new(0.5, 0.5, 0.5), Vector::new(0.5, 0.5, 0.0)];
        let around =
            (0..8).filter(|&cell| ends.iter().all(|&end| fine.corners(cell).any(|p| p == end)));
        assert_eq!(around.count(), 4);
    }
}
