//! Comparisons of whole surfaces (docs/verification.md#v39), aligned and not.

use std::collections::BTreeMap;

use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use mechanics::registration::{RigidTransform, SphereOrBox};
use mechanics::validation::{
    Alignment, Comparison, ComparisonError, ComparisonSettings, LandmarkPair, NodeWise, Region,
    compare,
};

use crate::scenes::StopsAfter;
use crate::surfaces::{head, map, movement, sphere, square};

fn compared(prediction: &TriangleSurface, actual: &TriangleSurface) -> Comparison {
    compare(prediction, actual, &ComparisonSettings::default(), &Unobserved).unwrap()
}

fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} instead of {wanted}");
}

fn icp(mask: Option<SphereOrBox>) -> ComparisonSettings {
    ComparisonSettings {
        alignment: Alignment::ClosestPoint { mask },
        ..ComparisonSettings::default()
    }
}

#[test]
fn concentric_spheres_are_their_radii_apart() {
    let (inner, outer) = (sphere(70.0, Vector::zeros(), 5), sphere(71.0, Vector::zeros(), 5));
    let found = compared(&inner, &outer).distances;
    for one in [found.to_actual, found.to_prediction, found.both] {
        let unsigned = one.unsigned;
        // Flat triangles of 2.6 mm are up to 0.013 mm nearer than the spheres.
        for value in [unsigned.mean, unsigned.rms, unsigned.p95, one.hausdorff] {
            assert_near(value, 1.0, 0.01);
        }
        assert_near(unsigned.sd, 0.0, 0.01);
        assert_eq!((one.share_below_2_mm, one.share_below_3_mm), (1.0, 1.0));
    }
    // The prediction is inside, seen from either surface.
    assert_near(found.to_actual.signed.mean, -1.0, 0.01);
    assert_near(found.to_prediction.signed.mean, -1.0, 0.01);
    assert_near(compared(&outer, &inner).distances.both.signed.mean, 1.0, 0.01);
}

#[test]
fn shifted_spheres_have_the_statistics_of_a_cosine() {
    let fixed = sphere(70.0, Vector::zeros(), 5);
    let shifted = sphere(70.0, Vector::new(0.6, -1.2, 1.483_239_697_419_132_5), 5);
    let found = compared(&fixed, &shifted).distances;
    for one in [found.to_actual, found.to_prediction, found.both] {
        let unsigned = one.unsigned;
        // |2 cos θ| over a sphere is uniform between 0 and 2; 1 % for the mesh.
        for (value, wanted) in [
            (unsigned.mean, 1.0),
            (unsigned.rms, 1.154_70),
            (unsigned.median, 1.0),
            (unsigned.p90, 1.8),
            (unsigned.p95, 1.9),
            (unsigned.p99, 1.98),
            (one.hausdorff, 2.0),
            (one.share_below_1_mm, 0.5),
            (one.area, one.area.min(2.0 * 4.0 * std::f64::consts::PI * 70.0 * 70.0)),
        ] {
            assert_near(value, wanted, 0.01 * wanted);
        }
        // Second order in the shift: 2²/(3 · 70) either way.
        assert_near(one.signed.mean, 0.0, 0.02);
        assert_near(one.signed.sd, 1.1547, 0.012);
    }
}

#[test]
fn a_small_patch_lies_on_a_large_plane_and_not_the_other_way_round() {
    let (patch, plane) = (square(10.0, 0.0, 2), square(100.0, 0.0, 20));
    let found = compared(&patch, &plane);
    let distances = &found.distances;
    assert_near(distances.to_actual.hausdorff, 0.0, 1e-13);
    // The corner of the plane is 45 mm in x and in y from that of the patch.
    assert_near(distances.to_prediction.hausdorff, 45.0 * 2.0_f64.sqrt(), 1e-12);
    assert_eq!(distances.both.hausdorff, distances.to_prediction.hausdorff);
    assert!(distances.to_prediction.unsigned.mean > 15.0);
    // Pooled by area: (0 · 100 + mean · 10000) / 10100.
    let pooled = distances.to_prediction.unsigned.mean * 10_000.0 / 10_100.0;
    assert_near(distances.both.unsigned.mean, pooled, 1e-9);
}

#[test]
fn a_scan_of_half_the_face_is_reported_as_such_and_measured_where_it_is() {
    let whole = head(5);
    let mut half = map(&whole, |point| point * 1.01);
    half.triangles.retain(|corners| whole.points[corners[0] as usize].x > 0.0);
    let found = compared(&whole, &half);
    assert!((0.4..0.6).contains(&found.coverage.of_prediction), "{:?}", found.coverage);
    assert_eq!((found.coverage.of_actual, found.coverage.to_prediction), (1.0, None));
    let covered = found.coverage.to_actual.unwrap();
    assert!(covered.hausdorff < 2.0 && found.distances.to_actual.hausdorff > 50.0);
    assert_eq!(found.warnings.iter().filter(|w| w.code == "partial-coverage").count(), 1);
    assert_eq!(found.node_wise, None);
}

#[test]
fn alignment_takes_the_actual_surface_back_and_says_how() {
    let prediction = head(5);
    let wanted = movement([4.0, -3.0, 5.0], [1.0, -2.0, 3.0]);
    let actual = map(&prediction, |point| wanted.inverse().apply(point));
    let landmarks = [100, 500, 900, 1700]
        .map(|i| LandmarkPair { prediction: prediction.points[i], actual: actual.points[i] });
    for alignment in
        [Alignment::Landmarks(landmarks.to_vec()), Alignment::ClosestPoint { mask: None }]
    {
        let settings = ComparisonSettings { alignment, ..ComparisonSettings::default() };
        let found = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
        let report = &found.alignment;
        assert_eq!(report.method, settings.alignment.name());
        assert_near(report.angle, wanted.angle(), 1e-9);
        assert!((report.transform.rotation - wanted.rotation).amax() < 1e-9);
        assert!((report.transform.translation - wanted.translation).amax() < 1e-7);
        let matrix = report.transform.matrix4();
        assert_eq!(
            (matrix[3], &matrix[12..]),
            (report.transform.translation.x, &[0.0, 0.0, 0.0, 1.0][..])
        );
        assert!(found.distances.both.hausdorff < 1e-7);
        assert!(found.unaligned.unwrap().both.unsigned.mean > 1.0);
        assert!(found.node_wise.unwrap().nodes.max < 1e-7);
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        assert!((found.aligned_actual.points[7] - prediction.points[7]).norm() < 1e-7);
    }
}

#[test]
fn without_alignment_nothing_moves_and_nothing_is_reported_twice() {
    let prediction = head(3);
    let actual = map(&prediction, |point| point + Vector::new(0.0, 0.0, 2.0));
    let found = compared(&prediction, &actual);
    assert_eq!(found.alignment.transform, RigidTransform::identity());
    assert_eq!((found.unaligned, found.alignment.rms), (None, None));
    assert_eq!(found.aligned_actual, actual);
    // Corresponding points are 2 mm apart, closest points never more.
    let node_wise = found.node_wise.unwrap();
    assert_near(node_wise.nodes.mean, 2.0, 1e-12);
    assert_near(node_wise.area.p95, 2.0, 1e-12);
    assert!(found.distances.to_actual.hausdorff <= 2.0 + 1e-12);
    let off = ComparisonSettings { report_unaligned: false, ..icp(None) };
    assert_eq!(compare(&prediction, &actual, &off, &Unobserved).unwrap().unaligned, None);
}

#[test]
fn the_signed_distance_at_a_point_is_positive_where_the_prediction_is_outside() {
    let found =
        compared(&sphere(70.0, Vector::new(2.0, 0.0, 0.0), 4), &sphere(70.0, Vector::zeros(), 4));
    let prediction = sphere(70.0, Vector::new(2.0, 0.0, 0.0), 4);
    assert_eq!(found.signed_distance.len(), prediction.points.len());
    for (point, signed) in prediction.points.iter().zip(&found.signed_distance) {
        // Flat triangles with edges of up to 6 mm are up to 0.1 mm inside the sphere.
        assert_near(*signed, point.norm() - 70.0, 0.1);
    }
}

#[test]
fn regions_measure_their_part_and_an_empty_one_is_refused() {
    let prediction = sphere(70.0, Vector::zeros(), 4);
    // The upper half has grown by 3 mm.
    let actual = map(&prediction, |p| if p.z > 0.0 { p * (73.0 / 70.0) } else { *p });
    let top = Region::SphereOrBox(SphereOrBox::Sphere {
        centre: Vector::new(0.0, 0.0, 75.0),
        radius: 30.0,
    });
    let bottom = SphereOrBox::Box {
        lower: Vector::new(-80.0, -80.0, -80.0),
        upper: Vector::new(80.0, 80.0, -20.0),
    };
    let mut settings = ComparisonSettings {
        regions: BTreeMap::from([
            ("top".to_owned(), top),
            ("bottom".to_owned(), Region::SphereOrBox(bottom)),
        ]),
        ..ComparisonSettings::default()
    };
    let found = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
    assert_near(found.regions["top"].both.signed.mean, -3.0, 0.03);
    assert!(found.regions["bottom"].both.hausdorff < 1e-9);
    assert!(found.regions["top"].to_actual.area < found.distances.to_actual.area);

    let nowhere = SphereOrBox::Sphere { centre: Vector::repeat(500.0), radius: 1.0 };
    settings.regions.insert("nose".to_owned(), Region::SphereOrBox(nowhere));
    let error = compare(&prediction, &actual, &settings, &Unobserved).unwrap_err();
    assert_eq!(error, ComparisonError::EmptyRegion { name: "nose".to_owned() });
    assert_eq!(error.code(), "empty-region");
}

#[test]
fn a_region_that_the_scan_does_not_reach_is_left_out_with_a_warning() {
    let (prediction, actual) = (square(100.0, 0.0, 10), square(20.0, 1.0, 2));
    let edge = SphereOrBox::Box {
        lower: Vector::repeat(30.0) - Vector::z() * 60.0,
        upper: Vector::repeat(60.0),
    };
    let settings = ComparisonSettings {
        regions: BTreeMap::from([("edge".to_owned(), Region::SphereOrBox(edge))]),
        ..ComparisonSettings::default()
    };
    let found = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
    assert!(found.regions.is_empty());
    assert!(found.warnings.iter().any(|warning| warning.code == "empty-region"));
}

#[test]
fn points_correspond_by_their_node_numbers_whatever_their_order() {
    let mut prediction = head(2);
    let count = prediction.points.len() as u32;
    prediction.node_ids = Some((0..count).map(|i| 1000 + 2 * i).collect());
    let mut actual = map(&prediction, |point| point + Vector::new(3.0, 0.0, 0.0));
    actual.points.reverse();
    actual.node_ids = prediction.node_ids.clone().map(|ids| ids.into_iter().rev().collect());
    for corner in actual.triangles.iter_mut().flatten() {
        *corner = count - 1 - *corner;
    }
    let found = compared(&prediction, &actual);
    assert_near(found.node_wise.unwrap().nodes.max, 3.0, 1e-12);

    actual.node_ids = None;
    assert_eq!(compared(&prediction, &actual).node_wise, None);
    let on = ComparisonSettings { node_wise: NodeWise::On, ..ComparisonSettings::default() };
    let error = compare(&prediction, &actual, &on, &Unobserved).unwrap_err();
    assert_eq!(error.code(), "not-corresponding");
    let off = ComparisonSettings { node_wise: NodeWise::Off, ..ComparisonSettings::default() };
    assert_eq!(compare(&prediction, &prediction, &off, &Unobserved).unwrap().node_wise, None);
}

#[test]
fn alignments_that_cannot_be_are_refused_by_one_code() {
    let surface = head(3);
    let pair = |point: Vector| LandmarkPair { prediction: point, actual: point };
    let on_a_line = (0..4).map(|i| pair(Vector::new(10.0, 0.0, 0.0) * f64::from(i))).collect();
    let outside = [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 900.0, 0.0]].map(|p| pair(Vector::from(p)));
    let nowhere = SphereOrBox::Sphere { centre: Vector::repeat(500.0), radius: 1.0 };
    for alignment in [
        Alignment::Landmarks(vec![pair(Vector::zeros()); 2]),
        Alignment::Landmarks(on_a_line),
        Alignment::Landmarks(outside.to_vec()),
        Alignment::Landmarks(vec![pair(Vector::repeat(f64::NAN)); 4]),
        Alignment::ClosestPoint { mask: Some(nowhere) },
    ] {
        let settings = ComparisonSettings { alignment, ..ComparisonSettings::default() };
        let error = compare(&surface, &surface, &settings, &Unobserved).unwrap_err();
        assert_eq!(error.code(), "alignment-failed", "{error}");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let surface = head(2);
    let settings = ComparisonSettings::default();
    let code = |prediction: &TriangleSurface, actual: &TriangleSurface| {
        compare(prediction, actual, &settings, &Unobserved).unwrap_err().code()
    };
    assert_eq!(code(&surface, &TriangleSurface::default()), "mesh-empty");
    assert_eq!(code(&TriangleSurface::default(), &surface), "mesh-empty");
    assert_eq!(code(&map(&surface, |_| Vector::zeros()), &surface), "mesh-empty");
    assert_eq!(code(&surface, &map(&surface, |p| p * f64::NAN)), "mesh-nonfinite");
    // Micrometres taken for millimetres.
    assert_eq!(code(&surface, &map(&surface, |p| p * 1000.0)), "too-many-samples");
    let cancelled =
        compare(&surface, &surface, &icp(None), &StopsAfter::iterations(0)).unwrap_err();
    assert_eq!(cancelled, ComparisonError::Cancelled);
}

#[test]
fn a_mirrored_scan_is_suspected() {
    let prediction = head(4);
    let actual = map(&prediction, |point| Vector::new(-point.x, point.y, point.z));
    for settings in [icp(None), ComparisonSettings::default()] {
        let found = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
        assert!(found.warnings.iter().any(|w| w.code == "mirrored?"), "{:?}", found.warnings);
    }
    let landmarks = [3, 40, 99, 120]
        .map(|i| LandmarkPair { prediction: prediction.points[i], actual: actual.points[i] });
    let alignment = Alignment::Landmarks(landmarks.to_vec());
    let settings = ComparisonSettings { alignment, ..ComparisonSettings::default() };
    let found = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
    assert!(found.warnings.iter().any(|w| w.code == "mirrored?"), "{:?}", found.warnings);
}

/// As a scan of a face that is nearly its own mirror image, beside which it lies turned.
#[test]
fn the_mirror_image_of_a_nearly_symmetric_head_is_suspected() {
    let lopsided = |point: Vector| {
        let bump =
            |middle: [f64; 3]| (-(point - Vector::from(middle)).norm_squared() / 800.0).exp();
        point * (1.0 + 0.02 * bump([60.0, -40.0, 20.0]) + 0.03 * bump([-50.0, 20.0, -60.0]))
    };
    let prediction = map(&head(4), |point| lopsided(*point));
    let turn = movement([4.0, -6.0, 9.0], [3.0, 2.0, -4.0]);
    let actual = map(&prediction, |point| turn.apply(&Vector::new(-point.x, point.y, point.z)));
    let suspected = |actual: &TriangleSurface| {
        let found = compare(&prediction, actual, &icp(None), &Unobserved).unwrap();
        found.warnings.iter().any(|warning| warning.code == "mirrored?")
    };
    assert!(suspected(&actual));
    assert!(!suspected(&map(&prediction, |point| turn.apply(point))));
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let prediction = head(4);
    let actual =
        map(&prediction, |p| movement([2.0, 1.0, -1.0], [0.5, 1.0, 2.0]).apply(&(p * 1.01)));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| compare(&prediction, &actual, &icp(None), &Unobserved).unwrap())
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one, three);
    assert!(one.distances.both.unsigned.mean > 0.1);
}

#[test]
fn a_far_origin_costs_a_comparison_no_accuracy() {
    let far = Vector::new(1e7, 1e7, -1e7);
    let prediction = head(4);
    let actual = map(&prediction, |point| point * 1.01 + Vector::new(0.0, 10.0, 0.0));
    let near = compare(&prediction, &actual, &icp(None), &Unobserved).unwrap();
    let there = |surface: &TriangleSurface| map(surface, |point| point + far);
    let found = compare(&there(&prediction), &there(&actual), &icp(None), &Unobserved).unwrap();
    assert_near(found.distances.both.unsigned.mean, near.distances.both.unsigned.mean, 1e-3);
    assert_near(found.distances.both.hausdorff, near.distances.both.hausdorff, 1e-3);
}
