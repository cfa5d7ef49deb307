//! Spheres and boxes cut by planes have the volumes of their closed forms (docs/verification.md#cuts).

use std::f64::consts::PI;

use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::osteotomy::clip::{ClipError, Halves, split};
use mechanics::osteotomy::surface_segment::{SegmentError, surface_segment};
use mechanics::osteotomy::{Cut, Extent, Osteotomy, Plane, Side};

use super::labelling::{plane, segment};
use crate::surfaces::sphere;

/// A box with its lowest corner at the origin.
fn cuboid(size: [f64; 3]) -> TriangleSurface {
    let corner = |n: usize| Vector::from([0, 1, 2].map(|axis| size[axis] * (n >> axis & 1) as f64));
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleSurface { points: (0..8).map(corner).collect(), triangles, node_ids: None }
}

fn together(parts: &[TriangleSurface]) -> TriangleSurface {
    parts.iter().fold(TriangleSurface::default(), |mut sum, part| {
        let first = sum.points.len() as u32;
        sum.points.extend(&part.points);
        sum.triangles.extend(part.triangles.iter().map(|t| t.map(|corner| corner + first)));
        sum
    })
}

fn inside_out(surface: TriangleSurface) -> TriangleSurface {
    let triangles = surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriangleSurface { triangles, ..surface }
}

/// Both parts closed, and their volumes together that of the whole.
fn checked(surface: &TriangleSurface, plane: &Plane) -> Halves {
    let halves = split(surface, plane).unwrap();
    for part in [&halves.below, &halves.above] {
        let edges = count_edges(&part.sorted_sides());
        assert_eq!((edges.open, edges.inconsistent), (0, 0));
    }
    let sum = halves.below.signed_volume() + halves.above.signed_volume();
    let whole = surface.signed_volume();
    assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} {whole}");
    halves
}

#[test]
fn a_sphere_cut_at_six_tenths_has_the_volumes_and_areas_of_its_cap() {
    let normal = Vector::new(1.0, -2.0, 3.0).normalize();
    let centre = Vector::new(5.0, 6.0, 7.0);
    let plane = Plane::new(centre + normal * 6.0, normal).unwrap();
    let halves = checked(&sphere(10.0, centre, 6), &plane);
    let near =
        |value: f64, wanted: f64| assert!((value / wanted - 1.0).abs() < 1e-3, "{value} {wanted}");
    near(halves.above.signed_volume(), 435.634181);
    near(halves.below.signed_volume(), 3753.156023);
    near(halves.cut_area_mm2, 201.061930);
    near(halves.above.area() - halves.cut_area_mm2, 251.327412);
}

#[test]
fn the_error_of_a_cut_sphere_is_that_of_its_mesh() {
    let plane = plane([0.0, 0.0, 6.0], [0.0, 0.0, 1.0]);
    let error = |levels: usize| {
        let cut = checked(&sphere(10.0, Vector::zeros(), levels), &plane);
        (cut.cut_area_mm2 - PI * 64.0).abs()
    };
    let [coarse, fine] = [error(4), error(6)];
    assert!(fine < coarse / 8.0, "{coarse} {fine}");
}

#[test]
fn a_box_cut_obliquely_has_exactly_its_volume_and_area() {
    let cut = plane([0.0, 0.0, 5.0], [-0.1, -0.2, 1.0]);
    let halves = checked(&cuboid([40.0, 30.0, 20.0]), &cut);
    assert!((halves.below.signed_volume() - 12000.0).abs() < 1e-9 * 12000.0);
    assert!((halves.cut_area_mm2 - 1229.634092).abs() < 1e-6);
    assert!((halves.cut_area_mm2 - 1200.0 * 1.05_f64.sqrt()).abs() < 1e-9);
}

#[test]
fn a_plane_through_corners_edges_and_faces_leaves_closed_parts_without_slivers() {
    let cube = cuboid([2.0; 3]);
    for (point, normal, below, area) in [
        ([0.0, 0.0, 0.0], [1.0, -1.0, 0.0], 4.0, 4.0 * 2.0_f64.sqrt()),
        ([2.0, 2.0, 0.0], [1.0, 1.0, 0.0], 8.0, 0.0),
        ([1.0, 1.0, 2.0], [0.0, 0.0, 1.0], 8.0, 0.0),
        ([1.0, 1.0, 0.0], [0.0, 0.0, 1.0], 0.0, 4.0),
        ([2.0, 0.0, 0.0], [1.0, 1.0, 1.0], 4.0 / 3.0, 2.0 * 3.0_f64.sqrt()),
    ] {
        let halves = checked(&cube, &plane(point, normal));
        assert!((halves.below.signed_volume() - below).abs() < 1e-12, "{point:?} {normal:?}");
        assert!((halves.cut_area_mm2 - area).abs() < 1e-12, "{point:?} {normal:?}");
    }
}

#[test]
fn a_cut_through_a_cavity_has_a_ring_for_a_cap() {
    let shell = together(&[
        sphere(10.0, Vector::zeros(), 5),
        inside_out(sphere(8.0, Vector::new(0.0, 0.0, 0.5), 5)),
    ]);
    let halves = checked(&shell, &plane([0.0, 0.0, 1.0], [0.05, 0.1, 1.0]));
    let height = 1.0 / (1.0 + 0.01 + 0.0025_f64).sqrt();
    let ring = PI * (100.0 - height * height) - PI * (64.0 - (0.5 * height).powi(2));
    assert!((halves.cut_area_mm2 / ring - 1.0).abs() < 5e-3, "{} {ring}", halves.cut_area_mm2);
}

#[test]
fn an_open_surface_is_refused_with_the_number_of_its_open_edges() {
    let mut open = cuboid([2.0; 3]);
    open.triangles.pop();
    let refused = split(&open, &plane([1.0; 3], [0.0, 0.0, 1.0]));
    assert_eq!(refused.unwrap_err(), ClipError::Open { edges: 3 });
}

/// A jaw between two planes, a stone beside it, and a cavity in each.
fn bones() -> TriangleSurface {
    let moved = |surface: TriangleSurface, by: Vector| TriangleSurface {
        points: surface.points.iter().map(|x| x + by).collect(),
        ..surface
    };
    together(&[
        cuboid([40.0, 10.0, 10.0]),
        inside_out(sphere(3.0, Vector::new(20.0, 5.0, 5.0), 3)),
        moved(cuboid([4.0; 3]), Vector::new(18.0, 20.0, 0.0)),
        inside_out(sphere(1.0, Vector::new(20.0, 22.0, 2.0), 3)),
    ])
}

fn rules(kerf: f64, seeds: &[[f64; 3]]) -> Osteotomy {
    let cut =
        |name: &str, x: f64| Cut::new(name, plane([x, 0.0, 0.0], [1.0, 0.0, 0.0]), None, kerf);
    let cuts = vec![cut("one", 10.0).unwrap(), cut("other", 30.0).unwrap()];
    Osteotomy::new(cuts, vec![segment("part", &[(0, Side::Above), (1, Side::Below)], seeds)])
        .unwrap()
}

#[test]
fn a_segment_is_the_closed_piece_between_its_cuts_with_its_cavity() {
    let cavity = sphere(3.0, Vector::zeros(), 3).signed_volume();
    for (kerf, length) in [(0.0, 20.0), (1.0, 19.0)] {
        let part = surface_segment(&bones(), &rules(kerf, &[]), 0).unwrap();
        assert!((part.volume_mm3 - (100.0 * length - cavity)).abs() < 1e-9, "{}", part.volume_mm3);
        assert_eq!(part.pieces, 2);
        let edges = count_edges(&part.surface.sorted_sides());
        assert_eq!((edges.open, edges.inconsistent), (0, 0));
    }
    let stone = surface_segment(&bones(), &rules(0.0, &[[20.0, 19.0, 1.0]]), 0).unwrap();
    let hollow = sphere(1.0, Vector::zeros(), 3).signed_volume();
    assert!((stone.volume_mm3 - (64.0 - hollow)).abs() < 1e-9, "{}", stone.volume_mm3);
}

#[test]
fn what_a_surface_cannot_be_cut_by_is_refused_by_name() {
    let disc = Some(Extent::Disc { radius: 3.0 });
    let disc = Cut::new("disc", plane([5.0; 3], [1.0, 0.0, 0.0]), disc, 0.0).unwrap();
    let seeds = [[1.0, 1.0, 1.0]];
    let rules = Osteotomy::new(vec![disc], vec![segment("part", &[(0, Side::Below)], &seeds)]);
    let refused = surface_segment(&bones(), &rules.unwrap(), 0);
    assert_eq!(refused.unwrap_err(), SegmentError::Bounded { cut: "disc".to_owned() });
    let nowhere = Cut::unbounded("cut", plane([-1.0; 3], [1.0, 0.0, 0.0]));
    let rules = Osteotomy::new(vec![nowhere], vec![segment("part", &[(0, Side::Below)], &[])]);
    let refused = surface_segment(&bones(), &rules.unwrap(), 0);
    assert_eq!(refused.unwrap_err(), SegmentError::NoBone { segment: "part".to_owned() });
}
