//! Tests of cuts.

use super::*;

fn square(kerf: f64) -> Cut {
    let plane = Plane::new(Vector::new(1.0, 2.0, 3.0), Vector::new(0.0, 0.0, 5.0)).unwrap();
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let corners = corners.map(|[x, y]| Vector::new(x, y, -7.0)).to_vec();
    Cut::new("square", plane, Some(Extent::Polygon { corners }), kerf).unwrap()
}

#[test]
fn a_polygon_parts_what_lies_across_it_and_nothing_beside_it() {
    let cut = square(0.0);
    let way = |x: f64, y: f64| [Vector::new(x, y, 2.5), Vector::new(x, y, 4.0)];
    for (x, y, parted) in
        [(2.0, 2.0, true), (3.9, 0.1, true), (4.1, 2.0, false), (-0.1, 2.0, false)]
    {
        let [below, above] = way(x, y);
        assert_eq!(cut.parts(&below, &above), parted, "{x} {y}");
        assert_eq!(cut.parts(&above, &below), parted, "{x} {y}");
        assert!(!cut.parts(&below, &Vector::new(x, y, 2.9)));
    }
}

#[test]
fn a_path_is_clipped_to_what_the_saw_reaches() {
    let cut = square(0.0);
    let path = |corners: &[[f64; 2]]| {
        corners.iter().map(|&[x, y]| Vector::new(x, y, 3.0)).collect::<Vec<_>>()
    };
    let area_of = |path: &[Vector]| {
        let corners: Vec<_> = path.iter().map(|p| flat(cut.plane(), p)).collect();
        area(&corners).abs()
    };
    // A larger square, one that sticks out on one side, and one beside.
    let clipped = |corners: &[[f64; 2]]| cut.clipped(&path(corners)).unwrap();
    let all = clipped(&[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]);
    assert!((area_of(&all) - 16.0).abs() < 1e-12);
    let half = clipped(&[[1.0, 1.0], [9.0, 1.0], [9.0, 3.0], [1.0, 3.0]]);
    assert!((area_of(&half) - 6.0).abs() < 1e-12, "{half:?}");
    assert!(clipped(&[[5.0, 5.0], [9.0, 5.0], [9.0, 9.0]]).is_empty());
    let within = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0]];
    assert_eq!(clipped(&within), path(&within));
}

#[test]
fn a_line_saws_parallelograms_that_meet_and_have_the_same_side_above() {
    let line = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 2.0], [9.0, 0.0, 2.0]];
    let line = line.map(Vector::from);
    let cuts = Cut::chained("step", &line, Vector::y() * -5.0, 0.5, 7).unwrap();
    let names: Vec<&str> = cuts.iter().map(|cut| cut.name.as_str()).collect();
    assert_eq!(names, ["step, piece 1", "step, piece 2", "step, piece 3"]);
    let normals: Vec<Vector> = cuts.iter().map(|cut| cut.plane().normal()).collect();
    assert_eq!(normals, [-Vector::z(), Vector::x(), -Vector::z()]);
    assert!(cuts.iter().all(|cut| cut.chain() == Some(7) && cut.kerf() == 0.5));
    let parts = |from: [f64; 3], to: [f64; 3]| {
        let (from, to) = (Vector::from(from), Vector::from(to));
        cuts.iter().filter(|cut| cut.parts(&from, &to)).count()
    };
    assert_eq!(parts([2.0, -1.0, -1.0], [2.0, -1.0, 1.0]), 1);
    assert_eq!(parts([6.0, -1.0, -1.0], [6.0, -1.0, 1.0]), 0, "below the step");
    assert_eq!(parts([6.0, -1.0, 1.0], [6.0, -1.0, 3.0]), 1);
    assert_eq!(parts([3.0, -1.0, 1.0], [5.0, -1.0, 1.0]), 1, "through the riser");
    assert_eq!(parts([2.0, -6.0, -1.0], [2.0, -6.0, 1.0]), 0, "deeper than it is sawn");
    let along = Cut::chained("cut", &line, Vector::x(), 0.0, 0).unwrap_err();
    assert_eq!(along, CutError::Normal);
}

#[test]
fn a_saw_with_a_width_leaves_nothing_within_half_of_it() {
    let cut = square(1.0);
    let at = |z: f64| Vector::new(2.0, 2.0, z);
    let sides = |z: f64| [Side::Below, Side::Above].map(|side| cut.leaves(&at(z), side));
    assert_eq!([2.4, 2.6, 3.4, 3.6].map(|z| cut.saws(&at(z))), [false, true, true, false]);
    assert_eq!(sides(2.4), [true, false]);
    assert_eq!(sides(2.6), [false, false]);
    assert_eq!(sides(3.6), [false, true]);
}

#[test]
fn the_axes_of_a_plane_are_right_handed() {
    for normal in [[0.0, 0.0, 2.0], [1.0, 1.0, 1.0], [-3.0, 0.1, 0.0]] {
        let plane = Plane::new(Vector::zeros(), Vector::from(normal)).unwrap();
        let [u, v] = plane.axes();
        assert!((u.cross(&v) - plane.normal()).norm() < 1e-15);
    }
}

#[test]
fn figures_that_cut_nothing_are_refused() {
    let plane = Plane::new(Vector::zeros(), Vector::z()).unwrap();
    let cut = |extent, kerf| Cut::new("cut", plane, extent, kerf).unwrap_err();
    assert_eq!(Plane::new(Vector::zeros(), Vector::zeros()), Err(CutError::Normal));
    assert_eq!(Plane::new(Vector::repeat(f64::NAN), Vector::z()), Err(CutError::Point));
    assert_eq!(cut(None, -1.0), CutError::Kerf { kerf: -1.0 });
    let disc = Extent::Disc { radius: 0.0 };
    assert_eq!(cut(Some(disc), 0.0), CutError::Radius { radius: 0.0 });
    let corners = vec![Vector::zeros(), Vector::x(), Vector::x() * 2.0];
    let line = cut(Some(Extent::Polygon { corners }), 0.0);
    assert_eq!(line, CutError::Polygon { corners: 3, area: 0.0 });
}
