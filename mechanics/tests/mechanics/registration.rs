//! Rigid movements from pairs of points and from surfaces (docs/verification.md#v30, docs/verification.md#v31).

use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use mechanics::registration::mirror::check_mirror;
use mechanics::registration::performed::{BoneBefore, align_base, align_base_from_any, performed};
use mechanics::registration::{
    AlignmentError, IterativeClosestPoint, RigidTransform, SphereOrBox, Start, ThinPlateSpline,
    align_points, align_weighted_points,
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
fn upper_part() -> SphereOrBox {
    SphereOrBox::Box { lower: Vector::new(-200.0, -200.0, -44.0), upper: Vector::repeat(200.0) }
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
        SphereOrBox::Box { lower: Vector::repeat(-200.0), upper: Vector::new(200.0, 200.0, -44.0) };
    let method = IterativeClosestPoint { mask: Some(changed), ..IterativeClosestPoint::default() };
    let pulled = method.align(&fixed, &moving, &Unobserved).unwrap();
    let (_, shift) = difference(&pulled.transform, &wanted, &Vector::zeros());
    assert!(shift > 1.0, "{shift}");
}

#[test]
fn copies_to_the_rounding_of_files_are_aligned_whatever_the_movement() {
    let rounded = |point: &Vector| point.map(|coordinate| f64::from(coordinate as f32));
    let fixed = map(&head(4), rounded);
    for number in 0..16 {
        let k = f64::from(number);
        let degrees = [12.0 - 1.3 * k, 3.0 + 0.7 * k, -6.0 + 0.9 * k];
        let wanted = movement(degrees, [5.6 - 0.4 * k, 0.3 * k, -2.0 + 0.2 * k]);
        let moving = map(&fixed, |point| rounded(&wanted.inverse().apply(point)));
        let found = IterativeClosestPoint::default().align(&fixed, &moving, &Unobserved);
        let found = found.unwrap_or_else(|error| panic!("{number}: {error}"));
        let (degrees, shift) = difference(&found.transform, &wanted, &Vector::zeros());
        assert!(degrees < 1e-3 && shift < 1e-3, "{number}: {degrees} degrees, {shift} mm");
    }
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
    let nowhere = SphereOrBox::Sphere { centre: Vector::repeat(1e4), radius: 1.0 };
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

/// docs/verification.md#thin-plate-spline: five landmarks of which one is moved across and one along.
fn bent_landmarks() -> (Vec<Vector>, Vec<Vector>) {
    let ten = 10.0;
    let from = [[0.0; 3], [ten, 0.0, 0.0], [0.0, ten, 0.0], [0.0, 0.0, ten], [ten; 3]];
    let from: Vec<Vector> = from.into_iter().map(Vector::from).collect();
    let mut to = from.clone();
    (to[1].y, to[4].x) = (0.5, 11.0);
    (from, to)
}

fn assert_at(found: Vector, wanted: [f64; 3]) {
    assert!((found - Vector::from(wanted)).amax() < 1e-9, "{found} instead of {wanted:?}");
}

#[test]
fn a_thin_plate_spline_has_the_numbers_of_another_program() {
    let (from, to) = bent_landmarks();
    let spline = ThinPlateSpline::new(&from, &to, 0.0).unwrap();
    for (place, target) in from.iter().zip(&to) {
        assert!((spline.apply(place) - target).amax() < 1e-12);
    }
    let (a, b) = (0.039_433_756_7, 0.019_716_878_4);
    let x: Vec<f64> = spline.weights().iter().map(|weight| weight.x).collect();
    for (found, wanted) in x.iter().zip([-a, b, b, b, -b]) {
        assert!((found - wanted).abs() < 1e-9, "{x:?}");
    }
    assert!(spline.weights().iter().all(|w| (w.y + 0.5 * w.x).abs() < 1e-12 && w.z.abs() < 1e-12));
    assert_at(spline.apply(&Vector::new(5.0, 5.0, 5.0)), [5.298_248_199_1, 5.100_875_900_5, 5.0]);
    assert_at(spline.apply(&Vector::new(2.0, 3.0, 4.0)), [2.113_723_967_5, 3.043_138_016_2, 4.0]);
    assert_at(
        spline.apply(&Vector::new(20.0, -5.0, 3.0)),
        [20.359_045_756_6, -4.179_522_878_3, 3.0],
    );
}

#[test]
fn smoothing_a_thin_plate_spline_lowers_its_energy_and_misses_landmarks() {
    let (from, to) = bent_landmarks();
    let spline = |smoothing: f64| ThinPlateSpline::new(&from, &to, smoothing).unwrap();
    let rms = |spline: &ThinPlateSpline| {
        let missed = from.iter().zip(&to).map(|(a, b)| (spline.apply(a) - b).norm_squared());
        (missed.sum::<f64>() / from.len() as f64).sqrt()
    };
    let smooth = spline(1.0);
    assert_at(smooth.apply(&Vector::new(5.0, 5.0, 5.0)), [5.300_189_928_5, 5.099_905_035_7, 5.0]);
    assert!((rms(&smooth) - 0.024_085).abs() < 1e-6, "{}", rms(&smooth));
    assert!((spline(0.0).bending_energy() - 0.0246).abs() < 5e-5);
    assert!((smooth.bending_energy() - 0.0184).abs() < 5e-5);
    // Nothing but the affine map is left in the end.
    let affine = spline(1e9);
    assert!((rms(&affine) - 0.176_78).abs() < 1e-5 && affine.bending_energy() < 1e-12);
}

#[test]
fn four_landmarks_make_an_affine_map_and_landmarks_in_a_plane_none() {
    let (from, to) = bent_landmarks();
    let affine = ThinPlateSpline::new(&from[..4], &to[..4], 0.0).unwrap();
    assert!(affine.weights().iter().all(|weight| weight.amax() < 1e-12));
    let flat: Vec<Vector> = from.iter().map(|p| Vector::new(p.x, p.y, 1.0)).collect();
    let error = ThinPlateSpline::new(&flat, &to, 0.0).unwrap_err();
    assert!(matches!(error, AlignmentError::Coplanar { .. }), "{error}");
    let error = ThinPlateSpline::new(&from[..3], &to[..3], 0.0).unwrap_err();
    assert_eq!(error, AlignmentError::FewLandmarks { points: 3, needed: 4 });
}

#[test]
fn two_landmarks_at_one_place_are_named_and_smoothing_takes_both() {
    let (mut from, mut to) = bent_landmarks();
    from.push(from[1]);
    to.push(to[1] + Vector::x());
    let other = from.len() - 1;
    let error = ThinPlateSpline::new(&from, &to, 0.0).unwrap_err();
    assert_eq!(error, AlignmentError::SamePlace { one: 1, other, distance: 0.0 });
    assert!(error.to_string().contains("landmarks 1 and"), "{error}");
    let between = ThinPlateSpline::new(&from, &to, 1.0).unwrap().apply(&from[1]);
    assert!(to[1].x < between.x && between.x < to[other].x, "{between}");
}

/// Bone of which the lower front was cut off, on triangles of a given fineness.
struct Skull {
    base: TriangleSurface,
    jaw: TriangleSurface,
}

fn skull(levels: usize) -> Skull {
    let whole = head(levels);
    let is_jaw = |t: &[u32; 3]| {
        let middle = t.iter().map(|&corner| whole.points[corner as usize]).sum::<Vector>() / 3.0;
        middle.z < -25.0 && middle.y < 10.0
    };
    let part = |belongs: bool| {
        let mut part = whole.clone();
        part.triangles.retain(|t| is_jaw(t) == belongs);
        part
    };
    Skull { base: part(false), jaw: part(true) }
}

fn joined(a: &TriangleSurface, b: &TriangleSurface) -> TriangleSurface {
    let offset = a.points.len() as u32;
    let shifted = b.triangles.iter().map(|corners| corners.map(|corner| corner + offset));
    TriangleSurface {
        points: [a.points.as_slice(), &b.points].concat(),
        triangles: a.triangles.iter().copied().chain(shifted).collect(),
        node_ids: None,
    }
}

#[test]
fn a_planted_operation_comes_back_from_bone_before_and_after_it() {
    let before = skull(6);
    let scan = movement([6.0, -4.0, 9.0], [12.0, -8.0, 5.0]);
    let pivot = Vector::new(0.0, -40.0, -60.0);
    for (degrees, shift) in
        [([0.0, 0.0, 0.0], [0.0, -5.0, 1.0]), ([3.0, -1.0, 2.0], [1.0, 4.0, -2.0])]
    {
        let turn = movement(degrees, [0.0; 3]).rotation;
        let planted = RigidTransform::about(&pivot, turn, Vector::from(shift));
        // After the operation: other triangles, holes, and another place in the scanner.
        let later = skull(5);
        let jaw = map(&later.jaw, |point| planted.apply(point));
        let mut after = map(&joined(&later.base, &jaw), |point| scan.inverse().apply(point));
        after.triangles.retain(|t| t[1] % 41 != 0);
        // Nothing was done above the ears.
        let mask = Some(SphereOrBox::Box {
            lower: Vector::new(-200.0, -200.0, 10.0),
            upper: Vector::repeat(200.0),
        });
        let base = BoneBefore {
            surface: &joined(&before.base, &before.jaw),
            mask,
            start: Start::AsItLies,
        };
        let base = align_base(&base, &after, &Unobserved).unwrap();
        let (angle, shift) = difference(&base.transform, &scan, &Vector::zeros());
        assert!(angle < 0.02 && shift < 0.03, "{angle} degrees, {shift} mm");
        assert!(base.rms < 0.05 && base.share_far < 0.001, "{base:?}");

        let segment = BoneBefore { surface: &before.jaw, mask: None, start: Start::AsItLies };
        let found = performed(&segment, &after, &base, &Unobserved).unwrap();
        let (angle, shift) = difference(&found.movement, &planted, &found.centre);
        assert!(angle < 0.05 && shift < 0.05, "{angle} degrees, {shift} mm, {found:?}");
        assert!(found.fit.rms < 0.05 && found.fit.share_far < 0.05, "{found:?}");
        assert!((found.centre.z + 60.0).abs() < 15.0, "{}", found.centre);
    }
}

#[test]
fn a_base_that_lies_too_far_off_for_its_place_is_found_from_another_start() {
    let before = skull(5);
    let whole = joined(&before.base, &before.jaw);
    let mask =
        SphereOrBox::Box { lower: Vector::new(-200.0, -200.0, 10.0), upper: Vector::repeat(200.0) };
    let base = BoneBefore { surface: &whole, mask: Some(mask), start: Start::AsItLies };
    let from_any = |scan: &RigidTransform| {
        let after = map(&whole, |point| scan.inverse().apply(point));
        let (found, start) = align_base_from_any(&base, &after, &Unobserved).unwrap();
        let (angle, shift) = difference(&found.transform, scan, &Vector::zeros());
        assert!(angle < 0.02 && shift < 0.03, "{angle} degrees, {shift} mm from {start:?}");
        (align_base(&base, &after, &Unobserved), found, start)
    };
    let (as_it_lies, found, start) = from_any(&movement([8.0, 5.0, -12.0], [2.0, -1.5, 0.9]));
    // Where the scans lie near enough nothing else is tried.
    assert_eq!((as_it_lies.unwrap(), Start::AsItLies), (found, start));
    let (as_it_lies, _, start) = from_any(&movement([10.0, 160.0, -20.0], [20.0, -15.0, 9.0]));
    assert!(as_it_lies.is_err() || as_it_lies.unwrap().share_far > 0.2, "it lies near enough");
    assert_eq!(start, Start::Inertia);
}
