//! What the readers do about dirt in surfaces.

use mechanics::format::{self, SurfaceOutput};
use mechanics::mesh::{Frame, TriangleSurface, Vector};

use crate::samples::{TRIANGLE, binary_stl, code_of, read_default, surface, warning_codes};

fn obj(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<u8> {
    let points = points.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n"));
    let faces = triangles
        .iter()
        .map(|triangle| triangle.map(|corner| corner + 1))
        .map(|[a, b, c]| format!("f {a} {b} {c}\n"));
    points.chain(faces).collect::<String>().into_bytes()
}

const SQUARE: [[f64; 3]; 4] =
    [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 100.0, 0.0], [0.0, 100.0, 0.0]];

#[test]
fn flat_triangles_are_dropped_and_a_file_of_nothing_else_is_refused() {
    let points = [SQUARE[0], SQUARE[1], SQUARE[2], [50.0, 0.0, 0.0]];
    let read = read_default(&obj(&points, &[[0, 1, 2], [0, 1, 3], [1, 1, 2]]));
    assert_eq!(warning_codes(&read), ["degenerate-triangles", "unreferenced-nodes"]);
    assert_eq!(read.warnings[0].numbers, [("count", 2.0)]);
    assert_eq!(surface(read).triangles, [[0, 1, 2]]);
    assert_eq!(code_of(&obj(&points, &[[0, 1, 3], [1, 1, 2]])), "mesh-degenerate");
}

#[test]
fn an_edge_too_short_for_the_size_of_the_surface_makes_a_flat_triangle() {
    let speck = [[1e-30, 0.0, 0.0], [0.0, 1e-30, 5e-324], [-0.0, 0.0, 0.0]];
    let points = [&SQUARE[..], &speck].concat();
    let read = read_default(&obj(&points, &[[0, 1, 2], [4, 5, 6]]));
    assert_eq!(surface(read).triangles, [[0, 1, 2]]);
}

#[test]
fn doubled_triangles_stay_once_whichever_way_they_face() {
    let triangles = [[0, 1, 2], [1, 2, 0], [0, 2, 1], [0, 2, 3]];
    let read = read_default(&obj(&SQUARE, &triangles));
    assert_eq!(warning_codes(&read), ["duplicate-triangles", "flipped-duplicates"]);
    assert_eq!(surface(read).triangles, [[0, 1, 2], [0, 2, 3]]);
}

fn cube() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let points = (0..8_u32)
        .map(|corner| [corner & 1, corner >> 1 & 1, corner >> 2].map(|bit| f64::from(bit) * 100.0));
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (points.collect(), triangles.collect())
}

#[test]
fn triangles_that_disagree_with_their_neighbours_are_turned() {
    // The first triangle may be one of them or not.
    for wrong in [[0, 5, 7], [3, 5, 7]] {
        let (points, mut triangles) = cube();
        for triangle in wrong {
            let corners: &mut [u32; 3] = &mut triangles[triangle];
            corners.swap(0, 1);
        }
        let read = read_default(&obj(&points, &triangles));
        assert_eq!(warning_codes(&read), ["triangles-flipped"]);
        assert_eq!(read.warnings[0].numbers, [("count", 3.0)]);
        // Exact: all products are whole numbers.
        assert_eq!(surface(read).signed_volume(), 1e6);
    }
}

#[test]
fn a_closed_surface_that_faces_inwards_is_turned_outwards() {
    let (points, mut triangles) = cube();
    for triangle in &mut triangles {
        triangle.swap(0, 1);
    }
    let read = read_default(&obj(&points, &triangles));
    assert_eq!(warning_codes(&read), ["surface-turned"]);
    assert_eq!(surface(read).signed_volume(), 1e6);
}

#[test]
fn a_far_origin_costs_no_digits_of_the_volume() {
    let (points, triangles) = cube();
    let far: Vec<Vector> =
        points.iter().map(|point| Vector::from(*point) + Vector::repeat(1e7)).collect();
    let cube = TriangleSurface { points: far, triangles, node_ids: None };
    assert_eq!(cube.signed_volume(), 1e6);
}

#[test]
fn bytes_behind_the_end_of_what_is_written_are_a_warning() {
    let (points, triangles) = cube();
    let points = points.into_iter().map(Vector::from).collect();
    let cube = TriangleSurface { points, triangles, node_ids: None };
    let output = SurfaceOutput::plain(&cube, Frame::Lps);
    for bytes in [format::ply::write(&output).unwrap(), format::vtk::vtp::write(&output).unwrap()] {
        assert_eq!(warning_codes(&read_default(&bytes)), [""; 0]);
        let read = read_default(&[&bytes[..], b"more"].concat());
        assert_eq!(warning_codes(&read), ["trailing-bytes"]);
        assert_eq!(read.warnings[0].numbers, [("bytes", 4.0)]);
    }
}

#[test]
fn bytes_behind_the_last_triangle_of_an_stl_are_a_warning() {
    let mut bytes = binary_stl(b"x", 1, &[TRIANGLE, TRIANGLE]);
    let read = read_default(&bytes);
    assert_eq!(warning_codes(&read), ["trailing-bytes"]);
    assert_eq!(surface(read).triangles.len(), 1);
    bytes.truncate(84 + 50);
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(surface(read_default(&bytes)).triangles.len(), 1);
}
