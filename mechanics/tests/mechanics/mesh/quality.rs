//! Cell quality, and the proof that a Jacobian is positive everywhere inside a cell.

use mechanics::mesh::jacobian::{jacobian_sign, scaled_jacobian, signed_volume, smallest_jacobian};
use mechanics::mesh::quality::{DihedralAngles, dihedral_angles, quality};
use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh, sample};

/// A hexahedron in the node order of VTK from one that counts x fastest, then y, then z.
fn from_lexicographic(corners: [[f64; 3]; 8]) -> Vec<Vector> {
    [0, 1, 3, 2, 4, 5, 7, 6].map(|place| Vector::from(corners[place])).to_vec()
}

/// docs/verification.md#v28: positive at every corner, folded inside.
fn folded_hexahedron() -> Vec<Vector> {
    from_lexicographic([
        [0.7, -0.6, -0.2],
        [1.3, 0.1, 0.0],
        [0.7, 0.7, 0.7],
        [0.3, 1.4, -0.6],
        [-0.5, -0.1, 0.9],
        [1.0, 0.4, 1.4],
        [0.7, 0.7, 0.6],
        [0.3, 1.6, 1.6],
    ])
}

fn mesh_of(shape: CellShape, corners: Vec<Vector>) -> VolumeMesh {
    let mut cells = Cells::default();
    let nodes: Vec<u32> = (0..corners.len() as u32).collect();
    cells.push(shape, &nodes);
    VolumeMesh { nodes: corners, cells, ..VolumeMesh::default() }
}

fn regular(shape: CellShape) -> Vec<Vector> {
    let height = 3.0_f64.sqrt() / 2.0;
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.5, height]];
    match shape {
        CellShape::Tet4 => vec![
            Vector::new(1.0, 1.0, 1.0),
            Vector::new(-1.0, 1.0, -1.0),
            Vector::new(1.0, -1.0, -1.0),
            Vector::new(-1.0, -1.0, 1.0),
        ],
        CellShape::Wedge6 => [0.0, 1.0]
            .into_iter()
            .flat_map(|z| triangle.map(|[x, y]| Vector::new(x, y, z)))
            .collect(),
        CellShape::Hex8 => from_lexicographic(
            [0, 1, 2, 3, 4, 5, 6, 7]
                .map(|corner| [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1].map(f64::from)),
        ),
    }
}

/// J = det ∂x/∂r of a hexahedron by differences of its trilinear map, which are exact along an axis.
fn jacobian_at(corners: &[Vector], [x, y, z]: [f64; 3]) -> f64 {
    let position = |x: f64, y: f64, z: f64| {
        let along_x = |a: usize, b: usize| corners[a] * (1.0 - x) + corners[b] * x;
        let along_y = |a: Vector, b: Vector| a * (1.0 - y) + b * y;
        along_y(along_x(0, 1), along_x(3, 2)) * (1.0 - z)
            + along_y(along_x(4, 5), along_x(7, 6)) * z
    };
    let columns = [
        position(1.0, y, z) - position(0.0, y, z),
        position(x, 1.0, z) - position(x, 0.0, z),
        position(x, y, 1.0) - position(x, y, 0.0),
    ];
    columns[0].cross(&columns[1]).dot(&columns[2])
}

#[test]
fn positive_corners_do_not_make_a_hexahedron_valid() {
    let corners = folded_hexahedron();
    let at_corners: Vec<f64> = (0..8)
        .map(|c| jacobian_at(&corners, [c & 1, (c >> 1) & 1, (c >> 2) & 1].map(f64::from)))
        .collect();
    let expected = [0.144, 2.324, 0.052, 0.608, 1.845, 2.965, 0.140, 0.206];
    for (found, told) in at_corners.iter().zip(expected) {
        // The table has three decimals.
        assert!((found - told).abs() < 6e-4, "{at_corners:?}");
    }
    let report = quality(&mesh_of(CellShape::Hex8, corners.clone()));
    assert_eq!((report.inverted, report.undecided), (1, 0));
    assert_eq!(report.inverted_cells[0].cell, 0);
    // The value of the table is the one halfway along an edge; along it J is a parabola, and its
    // lowest point lies a little beyond.
    let along = [0.0, 0.5, 1.0].map(|y| jacobian_at(&corners, [0.0, y, 0.0]));
    assert!((along[1] + 0.7645).abs() < 1e-12, "{along:?}");
    let (slope, curvature) =
        (4.0 * along[1] - 3.0 * along[0] - along[2], 2.0 * (along[0] - 2.0 * along[1] + along[2]));
    let lowest = along[0] - slope * slope / (4.0 * curvature);
    // Bounds are a millionth of the largest coefficient, about 3, apart.
    assert!((report.inverted_cells[0].jacobian - lowest).abs() < 3e-6, "{report:?} {lowest}");
    assert_eq!(report.warnings()[0].code, "mesh-inverted-elements");
}

#[test]
fn bounds_of_the_jacobian_hold_what_a_fine_grid_finds() {
    let corners = folded_hexahedron();
    let steps = 60;
    let mut smallest = f64::INFINITY;
    for i in 0..=steps {
        for j in 0..=steps {
            for k in 0..=steps {
                let place = [i, j, k].map(|n| f64::from(n) / f64::from(steps));
                smallest = smallest.min(jacobian_at(&corners, place));
            }
        }
    }
    let bounds = smallest_jacobian(CellShape::Hex8, &corners);
    assert!(bounds.lower <= bounds.upper && bounds.upper - bounds.lower < 1e-4, "{bounds:?}");
    // Half a step of the grid away from a minimum with curvature about 10 it is 1e-3 higher.
    assert!(bounds.lower <= smallest && smallest < bounds.upper + 2e-3, "{smallest} {bounds:?}");
}

#[test]
fn a_regular_cell_has_scaled_jacobian_one_and_its_volume() {
    let volumes = [
        (CellShape::Tet4, 8.0 / 3.0),
        (CellShape::Wedge6, 3.0_f64.sqrt() / 4.0),
        (CellShape::Hex8, 1.0),
    ];
    for (shape, volume) in volumes {
        let corners = regular(shape);
        assert!((scaled_jacobian(shape, &corners) - 1.0).abs() < 1e-14, "{shape:?}");
        assert!((signed_volume(shape, &corners) - volume).abs() < 1e-14, "{shape:?}");
        let sign = jacobian_sign(shape, &corners);
        assert!(sign.is_valid() && sign.halvings == 0, "{shape:?}");
    }
    for angle in dihedral_angles(&regular(CellShape::Tet4)) {
        assert!((angle - (1.0_f64 / 3.0).acos()).abs() < 1e-14);
    }
}

#[test]
fn a_mirrored_cell_is_inverted_whatever_its_shape() {
    for shape in [CellShape::Tet4, CellShape::Wedge6, CellShape::Hex8] {
        let mirrored = regular(shape).iter().map(|p| Vector::new(-p.x, p.y, p.z)).collect();
        let report = quality(&mesh_of(shape, mirrored));
        assert_eq!(report.inverted, 1, "{shape:?}");
        assert!(report.smallest_scaled_jacobian < -0.99, "{shape:?}");
        assert!(report.total_volume < 0.0, "{shape:?}");
    }
}

#[test]
fn a_wedge_that_folds_between_its_layers_is_found_from_positive_corners() {
    // The upper triangle is the lower one stretched by -1 and -3: right-handed both, but between
    // them J is √3/2 ((1-t)² + 3 t² - 4 t (1-t)), lowest at t = 3/8 with √3/2 (-1/8).
    let mut corners = regular(CellShape::Wedge6);
    for corner in &mut corners[3..] {
        *corner = Vector::new(-corner.x, -3.0 * corner.y, corner.z);
    }
    assert!(scaled_jacobian(CellShape::Wedge6, &corners) > 0.0);
    let bounds = jacobian_sign(CellShape::Wedge6, &corners);
    assert!(bounds.is_inverted());
    assert!((bounds.upper + 3.0_f64.sqrt() / 16.0).abs() < 1e-14, "{bounds:?}");
}

#[test]
fn a_flat_cell_is_not_valid() {
    let flat = regular(CellShape::Hex8).iter().map(|p| Vector::new(p.x, p.y, 0.0)).collect();
    let report = quality(&mesh_of(CellShape::Hex8, flat));
    assert_eq!(report.inverted, 1);
    assert_eq!(report.smallest_scaled_jacobian, 0.0);
}

#[test]
fn the_cells_of_a_block_fill_it_and_kuhns_tetrahedra_have_angles_from_45_to_90_degrees() {
    for shape in [CellShape::Tet4, CellShape::Wedge6, CellShape::Hex8] {
        let mesh = sample::block(Vector::new(2.0, 3.0, 4.0), [2, 3, 4], shape);
        let report = quality(&mesh);
        assert!((report.total_volume - 24.0).abs() < 1e-12, "{shape:?}");
        assert_eq!((report.inverted, report.undecided, report.subdivided), (0, 0, 0));
        assert_eq!(report.scaled_jacobian_histogram.iter().sum::<usize>(), mesh.cells.len());
        if let Some(angles) = DihedralAngles::of(&mesh) {
            assert!((angles.smallest.to_degrees() - 45.0).abs() < 1e-12);
            assert!((angles.largest.to_degrees() - 90.0).abs() < 1e-12);
            assert_eq!(angles.histogram.iter().sum::<usize>(), 6 * mesh.cells.len());
        } else {
            assert_ne!(shape, CellShape::Tet4);
        }
    }
}

#[test]
fn a_mesh_without_cells_has_no_quality_and_no_infinity() {
    let report = quality(&VolumeMesh::default());
    assert_eq!((report.smallest_volume, report.smallest_scaled_jacobian), (0.0, 0.0));
    assert!(report.warnings().is_empty());
}
