//! Rigid movements from pairs of points and from surfaces (docs/verification.md#v30, docs/verification.md#v31).

use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use mechanics::registration::mirror::check_mirror;
use mechanics::registration::{
    AlignmentError, IterativeClosestPoint, Place, RigidTransform, align_points,
    align_weighted_points,
};

use crate::scenes::StopsAfter;
use crate::surfaces::{Noise, difference, head, map, movement, sphere, square};

fn four_points() -> Vec<Vector> {
    vec![
        Vector::new(0.0, -70.0, -40.0),
        Vector::new(45.0, -30.0, 10.0),
        Vector::new(-44.0, -33.0, 12.0),
        Vector::new(2.0, -60.0, 55.0),
    ]
}

#[test]
fn four_points_that_moved_rigidly_give_back_their_movement() {
    let from = four_points();
    for degrees in [[7.0, -5.0, 11.0], [90.0, 0.0, 0.0], [180.0, 0.0, 0.0], [170.0, 60.0, -150.0]] {
        let wanted = movement(degrees, [1.5, -0.7, 5.0]);
        let to: Vec<Vector> = from.iter().map(|point| wanted.apply(point)).collect();
        let found = align_points(&from, &to).unwrap();
        // Coordinates up to 100 mm carry 1e-14 each.
        assert!((found.transform.rotation - wanted.rotation).amax() < 1e-12);
        assert!((found.transform.translation - wanted.translation).amax() < 1e-12);
        assert!(found.rms < 1e-12);
        assert!(found.mirrored_rms > 10.0);
    }
}

#[test]
fn a_mirrored_set_still_gives_a_rotation() {
    let from = four_points();
    let to: Vec<Vector> = from.iter().map(|p| Vector::new(-p.x, p.y, p.z)).collect();
    let found = align_points(&from, &to).unwrap();
    assert!((found.transform.rotation.determinant() - 1.0).abs() < 1e-12);
    assert!(found.mirrored_rms < 1e-12 && found.rms > 1.0, "{found:?}");
}

#[test]
fn points_in_a_plane_determine_a_movement_and_points_on_a_line_do_not() {
    let wanted = movement([20.0, 30.0, 40.0], [1.0, 2.0, 3.0]);
    let moved = |points: &[Vector]| points.iter().map(|p| wanted.apply(p)).collect::<Vec<_>>();
    let plane = &four_points()[..3];
    let found = align_points(plane, &moved(plane)).unwrap().transform;
    assert!((found.rotation - wanted.rotation).amax() < 1e-12);
    assert!((found.rotation.determinant() - 1.0).abs() < 1e-12);

    let line: Vec<Vector> = (0..5).map(|i| Vector::new(1.0, 2.0, 3.0) * f64::from(i)).collect();
    let error = align_points(&line, &moved(&line)).unwrap_err();
    assert!(matches!(error, AlignmentError::Collinear { .. }), "{error}");
    let one_place = vec![Vector::new(1.0, 2.0, 3.0); 4];
    let error = align_points(&one_place, &one_place).unwrap_err();
    assert!(matches!(error, AlignmentError::Collinear { .. }), "{error}");
}

#[test]
fn too_few_unpaired_or_infinite_points_are_refused() {
    let points = four_points();
    let error = align_points(&points[..2], &points[..2]).unwrap_err();
    assert_eq!(error, AlignmentError::TooFewPoints { points: 2 });
    let error = align_points(&points, &points[..3]).unwrap_err();
    assert_eq!(error, AlignmentError::NotPaired { from: 4, to: 3 });
    let mut broken = points.clone();
    broken[2].y = f64::NAN;
    assert_eq!(align_points(&points, &broken).unwrap_err(), AlignmentError::NotFinite { pair: 2 });
}

#[test]
fn a_pair_of_weight_zero_does_not_count() {
    let wanted = movement([7.0, -5.0, 11.0], [1.5, -0.7, 5.0]);
    let from = four_points();
    let mut to: Vec<Vector> = from.iter().map(|point| wanted.apply(point)).collect();
    to[3] += Vector::new(30.0, 0.0, 0.0);
    let found = align_weighted_points(&from, &to, &[1.0, 2.0, 3.0, 0.0]).unwrap();
    assert!((found.transform.rotation - wanted.rotation).amax() < 1e-12);
    assert!(align_points(&from, &to).unwrap().rms > 1.0);
}

/// The upper part of the head: 70 % of its points, the part that surgery leaves alone.
fn upper_part() -> Place {
    Place::Box { lower: Vector::new(-200.0, -200.0, -44.0), upper: Vector::repeat(200.0) }
}

/// A head before, and the same head moved with its lower 30 % of points displaced by some mm.
fn operated_head(wanted: &RigidTransform, noise: f64) -> (TriangleSurface, TriangleSurface) {
    let mask = upper_part();
    let mut random = Noise::new(1);
    let mut noisy = |point: &Vector| point + random.vector() * noise;
    let fixed = head(5);
    let outside = fixed.points.iter().filter(|point| !mask.holds(point)).count();
    let share = outside as f64 / fixed.points.len() as f64;
    assert!((0.28..0.35).contains(&share), "{share}");
    let back = wanted.inverse();
    let mut moving = fixed.clone();
    for point in &mut moving.points {
        if !mask.holds(point) {
            let depth = (-44.0 - point.z).min(10.0);
            *point += Vector::new(0.0, -0.9, 0.3) * depth + Vector::new(2.0, 0.0, 0.0);
        }
        *point = back.apply(&noisy(point));
    }
    let mut measured = fixed.clone();
    for point in &mut measured.points {
        *point = noisy(point);
    }
    (measured, moving)
}

#[test]
fn a_masked_head_is_brought_back_although_a_third_of_it_has_changed() {
    // The actual surface lies where the movement took it; the alignment has to undo that.
    let wanted = movement([7.0, -5.0, 11.0], [1.5, -0.7, 5.0]);
    let (fixed, moving) = operated_head(&wanted, 0.0);
    let method =
        IterativeClosestPoint { mask: Some(upper_part()), ..IterativeClosestPoint::default() };
    let found = method.align(&fixed, &moving, &Unobserved).unwrap();
    let (degrees, shift) = difference(&found.transform, &wanted, &Vector::zeros());
    assert!(degrees < 0.01 && shift < 0.01, "{degrees} degrees, {shift} mm, {found:?}");
    // The changed part alone leads elsewhere.
    let changed =
        Place::Box { lower: Vector::repeat(-200.0), upper: Vector::new(200.0, 200.0, -44.0) };
    let method = IterativeClosestPoint { mask: Some(changed), ..IterativeClosestPoint::default() };
    let pulled = method.align(&fixed, &moving, &Unobserved).unwrap();
    let (_, shift) = difference(&pulled.transform, &wanted, &Vector::zeros());
    assert!(shift > 1.0, "{shift}");
}

#[test]
fn noise_of_a_third_of_a_millimetre_costs_less_than_a_tenth() {
    let wanted = movement([7.0, -5.0, 11.0], [1.5, -0.7, 5.0]);
    let (fixed, moving) = operated_head(&wanted, 0.3);
    let method =
        IterativeClosestPoint { mask: Some(upper_part()), ..IterativeClosestPoint::default() };
    let found = method.align(&fixed, &moving, &Unobserved).unwrap();
    let (_, shift) = difference(&found.transform, &wanted, &Vector::zeros());
    assert!(shift < 0.1, "{shift} mm, {found:?}");
}

#[test]
fn another_triangulation_of_the_same_head_lands_in_the_same_place() {
    let wanted = movement([7.0, -5.0, 11.0], [1.5, -0.7, 5.0]);
    let coarse = map(&head(5), |point| wanted.inverse().apply(point));
    let found = IterativeClosestPoint::default().align(&head(6), &coarse, &Unobserved).unwrap();
    let (degrees, shift) = difference(&found.transform, &wanted, &Vector::zeros());
    // The coarse triangles lie up to 0.02 mm inside the fine ones.
    assert!(degrees < 0.01 && shift < 0.02, "{degrees} degrees, {shift} mm, {found:?}");
}

#[test]
fn a_far_origin_costs_no_accuracy() {
    let far = Vector::new(1e7, -1e7, 1e7);
    let fixed = map(&head(4), |point| point + far);
    // A small turn about the head, not about the origin, and 10 mm.
    let turn = movement([2.0, -1.0, 3.0], [0.0; 3]).rotation;
    let wanted = RigidTransform::about(&far, turn, Vector::new(6.0, 0.0, 8.0));
    let moving = map(&fixed, |point| wanted.inverse().apply(point));
    let found = IterativeClosestPoint::default().align(&fixed, &moving, &Unobserved).unwrap();
    for (point, original) in moving.points.iter().zip(&fixed.points) {
        assert!((found.transform.apply(point) - original).norm() < 1e-3);
    }
    let pairs = align_points(&moving.points, &fixed.points).unwrap().transform;
    for (point, original) in moving.points.iter().zip(&fixed.points) {
        assert!((pairs.apply(point) - original).norm() < 1e-6);
    }
}

#[test]
fn surfaces_in_different_places_start_with_their_middles_together() {
    let fixed = head(4);
    let wanted = movement([3.0, 2.0, -4.0], [500.0, -800.0, 1e7]);
    let moving = map(&fixed, |point| wanted.inverse().apply(point));
    let found = IterativeClosestPoint::default().align(&fixed, &moving, &Unobserved).unwrap();
    for (point, original) in moving.points.iter().zip(&fixed.points) {
        assert!((found.transform.apply(point) - original).norm() < 1e-3);
    }
}

#[test]
fn half_a_head_is_aligned_to_the_whole() {
    let whole = head(5);
    let wanted = movement([3.0, -2.0, 4.0], [1.5, -0.7, 3.0]);
    let mut half = map(&whole, |point| wanted.inverse().apply(point));
    half.triangles.retain(|corners| whole.points[corners[0] as usize].x > 0.0);
    let found = IterativeClosestPoint::default().align(&whole, &half, &Unobserved).unwrap();
    let (degrees, shift) = difference(&found.transform, &wanted, &Vector::zeros());
    assert!(degrees < 0.01 && shift < 0.01, "{degrees} degrees, {shift} mm, {found:?}");
}

#[test]
fn a_sphere_or_a_plane_is_not_turned_about_nothing() {
    let fixed = sphere(70.0, Vector::zeros(), 4);
    let moving = sphere(70.0, Vector::new(1.0, 2.0, -1.0), 4);
    let found = IterativeClosestPoint::default().align(&fixed, &moving, &Unobserved).unwrap();
    let middle = found.transform.apply(&Vector::new(1.0, 2.0, -1.0));
    assert!(middle.norm() < 1e-3, "{middle}");
    // The larger plane has no border opposite the smaller one.
    let (fixed, moving) = (square(50.0, 0.0, 5), square(100.0, 3.0, 10));
    let found = IterativeClosestPoint::default().align(&fixed, &moving, &Unobserved).unwrap();
    let moved = found.transform.apply(&Vector::new(1.0, 2.0, 3.0));
    assert!((moved - Vector::new(1.0, 2.0, 0.0)).norm() < 1e-9, "{moved}");
}

#[test]
fn an_empty_mask_a_hasty_limit_and_a_cancelled_alignment_are_named() {
    let fixed = head(3);
    let moving = map(&fixed, |point| movement([7.0, -5.0, 11.0], [1.5, -0.7, 5.0]).apply(point));
    let nowhere = Place::Sphere { centre: Vector::repeat(1e4), radius: 1.0 };
    let method = IterativeClosestPoint { mask: Some(nowhere), ..Default::default() };
    assert_eq!(method.align(&fixed, &moving, &Unobserved).unwrap_err(), AlignmentError::EmptyMask);

    let method = IterativeClosestPoint { max_iterations: 1, ..Default::default() };
    let error = method.align(&fixed, &moving, &Unobserved).unwrap_err();
    assert!(matches!(error, AlignmentError::NotConverged { wanted: 1e-6, .. }), "{error}");

    let error = IterativeClosestPoint::default()
        .align(&fixed, &moving, &StopsAfter::iterations(0))
        .unwrap_err();
    assert_eq!(error, AlignmentError::Cancelled { iterations: 0 });
}

#[test]
fn a_mirrored_scan_looks_mirrored_and_a_moved_one_does_not() {
    let fixed = head(4);
    let moved = map(&fixed, |p| movement([3.0, -2.0, 4.0], [1.5, -0.7, 3.0]).apply(p));
    let start = RigidTransform::identity();
    let check = check_mirror(&fixed, &moved, None, &start).unwrap();
    assert!(!check.looks_mirrored(), "{check:?}");
    let mirrored = map(&moved, |point| Vector::new(-point.x, point.y, point.z));
    let check = check_mirror(&fixed, &mirrored, None, &start).unwrap();
    assert!(check.looks_mirrored(), "{check:?}");
    // A sphere is its own mirror image.
    let ball = sphere(70.0, Vector::zeros(), 4);
    assert!(!check_mirror(&ball, &ball, None, &start).unwrap().looks_mirrored());
}
