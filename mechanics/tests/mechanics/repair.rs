//! Repair of noisy hexahedra, beside the rule of corners.

use mechanics::mesh::quality::quality;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::progress::Unobserved;
use mechanics::repair::corner_rule::repair_by_corners;
use mechanics::repair::noisy::noisy_block;
use mechanics::repair::{Bounds, RepairReport, repair};

fn repaired(mesh: &VolumeMesh) -> (VolumeMesh, RepairReport) {
    let mut copy = mesh.clone();
    let report = repair(&mut copy, &Bounds::of(mesh, 1.0, 3.0), &Unobserved);
    (copy, report)
}

#[test]
fn every_cell_is_proven_valid_or_named_and_no_node_leaves_its_bounds() {
    for (noise, seed) in (0..10).flat_map(|seed| [(0.35, seed), (0.45, seed)]) {
        let mesh = noisy_block(noise, seed);
        let (mended, report) = repaired(&mesh);
        let after = quality(&mended);
        let told = quality(&mesh);
        assert_eq!(report.unproven_before, told.inverted + told.undecided);
        assert_eq!(report.unproven.len(), after.inverted + after.undecided, "seed {seed}");
        let bounds = Bounds::of(&mesh, 1.0, 3.0);
        for (node, farthest) in bounds.farthest.iter().enumerate() {
            assert!((mended.nodes[node] - mesh.nodes[node]).norm() <= farthest + 1e-9);
        }
    }
}

#[test]
fn noise_of_a_third_and_of_nearly_half_a_cell_is_mended_whole() {
    for (noise, seed) in (0..100).flat_map(|seed| [(0.35, seed), (0.45, seed)]) {
        let (_, report) = repaired(&noisy_block(noise, seed));
        assert!(report.unproven_before > 0, "noise {noise}, seed {seed}");
        assert_eq!(report.unproven, [], "noise {noise}, seed {seed}");
    }
}

#[test]
fn wedges_of_noisy_nodes_are_proven_valid() {
    let mut unproven = 0;
    for seed in 0..10 {
        let hexahedra = noisy_block(0.3, seed);
        let mut wedges = VolumeMesh { cells: Default::default(), ..hexahedra.clone() };
        for (_, nodes) in hexahedra.cells.iter() {
            // Two wedges of a hexahedron, below and above the diagonal of its first face.
            for corners in [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]] {
                wedges.cells.push(CellShape::Wedge6, &corners.map(|corner| nodes[corner]));
            }
        }
        let (mended, report) = repaired(&wedges);
        unproven += report.unproven_before;
        assert_eq!(report.unproven, [], "seed {seed}");
        assert_eq!(quality(&mended).inverted, 0, "seed {seed}");
    }
    assert!(unproven > 0);
}

#[test]
fn the_rule_of_corners_passes_cells_that_are_inverted_inside() {
    let wrong = (0..30).filter(|&seed| {
        let mut mesh = noisy_block(0.45, seed);
        let bounds = Bounds::of(&mesh, 1.0, 3.0);
        repair_by_corners(&mut mesh, &bounds).is_some() && quality(&mesh).inverted > 0
    });
    assert!(wrong.count() > 0);
}

#[test]
fn nodes_of_a_surface_stay_on_their_tangent_planes() {
    let mesh = noisy_block(0.35, 3);
    let top = mesh.node_sets["z_max"].clone();
    let bounds = Bounds::of(&mesh, 1.0, 3.0).along(&mesh, &[&top]);
    let mut mended = mesh.clone();
    let report = repair(&mut mended, &bounds, &Unobserved);
    assert!(report.nodes_moved > 0);
    for &node in &top {
        let normal = bounds.normals[node as usize].unwrap();
        let moved = mended.nodes[node as usize] - mesh.nodes[node as usize];
        assert!(moved.dot(&normal).abs() < 1e-9);
    }
}

#[test]
fn a_node_of_a_surface_without_a_normal_stays_where_it_is() {
    // Tetrahedra on both sides of a plane that meet in one node: its triangles cancel.
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let up = corners.map(Vector::from);
    let mut mesh = VolumeMesh { nodes: up.to_vec(), ..VolumeMesh::default() };
    mesh.nodes.extend(up[1..].iter().map(|x| -x));
    mesh.cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
    mesh.cells.push(CellShape::Tet4, &[0, 5, 4, 6]);
    let bounds = Bounds::of(&mesh, 1.0, 3.0).along(&mesh, &[&[0, 1]]);
    assert_eq!((bounds.normals[0], bounds.farthest[0]), (None, 0.0));
    assert!(bounds.normals[1].is_some() && bounds.farthest[1] == 1.0);
}

#[test]
fn a_sound_mesh_is_left_as_it_is() {
    let mesh = noisy_block(0.05, 1);
    let (same, report) = repaired(&mesh);
    assert_eq!(same, mesh);
    assert_eq!(report, RepairReport::default());
}

#[test]
fn a_cell_that_cannot_be_mended_is_named_with_its_jacobian() {
    let mut mesh = noisy_block(0.0, 0);
    mesh.nodes[60] += Vector::new(0.0, 0.0, 9.0);
    let mut mended = mesh.clone();
    let bounds = Bounds::of(&mesh, 0.0, 0.0);
    let report = repair(&mut mended, &bounds, &Unobserved);
    assert_eq!(mended, mesh);
    assert!(!report.unproven.is_empty());
    assert!(report.unproven.iter().all(|cell| cell.smallest_jacobian <= 0.0));
}
