//! A prediction against scans: how they are aligned, where they are measured, and whether they are meant.

use std::collections::BTreeMap;

use mechanics::mesh::{TriangleSurface, Vector, Warning};
use mechanics::progress::Unobserved;
use mechanics::registration::{SphereOrBox, Start};
use mechanics::validation::penetration::overlap;
use mechanics::validation::{
    Alignment, BoneSurfaces, Comparison, ComparisonError, ComparisonSettings, LandmarkPair, Region,
    compare,
};

use crate::surfaces::{head, map, movement, sphere, square};

fn compared(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    settings: &ComparisonSettings,
) -> Comparison {
    compare(prediction, actual, settings, &Unobserved).unwrap()
}

fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} instead of {wanted}");
}

fn codes(warnings: &[Warning]) -> Vec<&'static str> {
    warnings.iter().map(|warning| warning.code).collect()
}

/// A chin that is moved forward: up to 6 mm at the lowest front of a head, nothing behind.
fn advancement(point: &Vector) -> Vector {
    let distance = (point - Vector::new(8.0, -75.0, -70.0)).norm();
    Vector::new(0.0, -6.0, 0.0) * (-(distance / 30.0).powi(2)).exp()
}

/// A skull of the size of the head's inside.
fn skull() -> TriangleSurface {
    map(&head(5), |point| point * 0.8 + Vector::new(3.0 * (point.z / 20.0).sin(), 0.0, 0.0))
}

#[test]
fn a_known_matrix_moves_the_actual_surface_and_nothing_else_does() {
    let prediction = head(4);
    let known = movement([4.0, -3.0, 5.0], [40.0, -2.0, 3.0]);
    let actual = map(&prediction, |point| known.inverse().apply(point));
    let settings =
        ComparisonSettings { alignment: Alignment::Matrix(known), ..ComparisonSettings::default() };
    let found = compared(&prediction, &actual, &settings);
    assert_eq!(found.alignment.transform, known);
    assert_eq!((found.alignment.method, found.alignment.rms), ("matrix", None));
    assert!(found.distances.both.hausdorff < 1e-9);
    assert!(found.unaligned.unwrap().both.unsigned.mean > 10.0);
}

#[test]
fn a_surface_that_faces_inwards_and_one_of_another_frame_are_reported() {
    let prediction = head(4);
    let larger = map(&prediction, |point| point * 1.03);
    let mut turned = larger.clone();
    turned.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let far = map(&prediction, |point| point + Vector::new(0.0, 400.0, 0.0));
    let told = |actual: &TriangleSurface| {
        let found = compared(&prediction, actual, &ComparisonSettings::default()).warnings;
        ["surfaces-opposed", "surfaces-apart"].map(|code| codes(&found).contains(&code))
    };
    assert_eq!(told(&larger), [false, false]);
    assert_eq!(told(&turned), [true, false]);
    assert!(told(&far)[1]);
}

#[test]
fn bone_decides_where_the_skin_goes_and_the_operation_is_left() {
    let scan_frame = movement([12.0, -7.0, 20.0], [30.0, 15.0, -25.0]);
    let at_rest = head(5);
    let prediction = map(&at_rest, |point| point + advancement(point));
    let actual = map(&prediction, |point| scan_frame.inverse().apply(point));
    let skull = skull();
    let bones = |start: Start| {
        let moving = map(&skull, |point| scan_frame.inverse().apply(point));
        let mask = Some(SphereOrBox::Box {
            lower: Vector::repeat(-200.0),
            upper: Vector::new(200.0, 200.0, 200.0),
        });
        Alignment::Surfaces(Box::new(BoneSurfaces { fixed: skull.clone(), moving, mask, start }))
    };
    for start in [Start::AsItLies, Start::Boxes, Start::Inertia, Start::Known(scan_frame)] {
        let settings =
            ComparisonSettings { alignment: bones(start), ..ComparisonSettings::default() };
        let found = compared(&prediction, &actual, &settings);
        let report = &found.alignment;
        assert!((report.transform.rotation - scan_frame.rotation).amax() < 1e-6, "{start:?}");
        assert!((report.transform.translation - scan_frame.translation).amax() < 1e-4, "{start:?}");
        assert!(found.node_wise.unwrap().nodes.max < 1e-3, "{start:?}");
        assert_eq!((report.method, report.share_far), ("surfaces", Some(0.0)));
        assert_eq!(codes(&found.warnings), Vec::<&str>::new());
    }
    // The skin by itself would be turned to make up for the operation.
    let unoperated = map(&at_rest, |point| scan_frame.inverse().apply(point));
    let by = |alignment: Alignment| {
        let settings = ComparisonSettings { alignment, ..ComparisonSettings::default() };
        compared(&prediction, &unoperated, &settings).node_wise.unwrap().nodes.max
    };
    let largest = prediction.points.iter().zip(&at_rest.points).map(|(a, b)| (a - b).norm());
    assert_near(by(bones(Start::AsItLies)), largest.fold(0.0, f64::max), 1e-3);
}

#[test]
fn a_head_turned_by_seventy_degrees_is_found_by_its_axes() {
    let prediction = head(5);
    let far = movement([70.0, -10.0, 15.0], [300.0, 40.0, -200.0]);
    let bones = |start: Start| BoneSurfaces {
        fixed: prediction.clone(),
        moving: map(&prediction, |point| far.inverse().apply(point)),
        mask: None,
        start,
    };
    let settings = ComparisonSettings {
        alignment: Alignment::Surfaces(Box::new(bones(Start::Inertia))),
        ..ComparisonSettings::default()
    };
    let actual = bones(Start::Inertia).moving;
    let found = compared(&prediction, &actual, &settings);
    assert!((found.alignment.transform.rotation - far.rotation).amax() < 1e-6);
    assert!(found.distances.both.hausdorff < 1e-3);
}

#[test]
fn what_the_plan_does_not_move_can_be_left_out() {
    // A square of 100 mm of which a disc moves; the scan is 1 mm above it there, and 0 elsewhere.
    let prediction = square(100.0, 0.0, 100);
    let is_moved = |point: &Vector| point.xy().norm() < 20.0;
    let actual = map(&prediction, |p| p + Vector::z() * if is_moved(p) { 1.0 } else { 0.0 });
    let displacement: Vec<Vector> = prediction
        .points
        .iter()
        .map(|point| Vector::new(0.0, if is_moved(point) { 3.0 } else { 0.0 }, 0.0))
        .collect();
    let mut settings = ComparisonSettings {
        regions: BTreeMap::from([
            ("moved".to_owned(), Region::MovedByMoreThan(1.5)),
            ("left half".to_owned(), Region::Points(left_half(&prediction))),
        ]),
        displacement: Some(displacement),
        ..ComparisonSettings::default()
    };
    let found = compared(&prediction, &actual, &settings);
    let moved = &found.regions["moved"];
    let disc = std::f64::consts::PI * 400.0;
    assert_near(moved.to_actual.area, disc, 0.02 * disc);
    // Within 1 mm of the border of the disc the scan is a slope.
    assert!(moved.to_actual.unsigned.mean > 0.95 && found.distances.to_actual.unsigned.mean < 0.14);
    assert_near(moved.to_prediction.area, disc, 0.1 * disc);
    let half = &found.regions["left half"];
    assert_near(half.to_actual.area, 5000.0, 1e-9);
    assert_near(half.to_prediction.area, 5000.0, 150.0);

    settings.regions = [("none".to_owned(), Region::MovedByMoreThan(4.0))].into();
    let error = compare(&prediction, &actual, &settings, &Unobserved).unwrap_err();
    assert_eq!(error, ComparisonError::EmptyRegion { name: "none".to_owned() });
    settings.displacement = None;
    let error = compare(&prediction, &actual, &settings, &Unobserved).unwrap_err();
    assert_eq!(error.code(), "no-displacement");
}

fn left_half(square: &TriangleSurface) -> Vec<u32> {
    let points = square.points.iter().enumerate().filter(|(_, point)| point.x <= 1e-9);
    points.map(|(number, _)| number as u32).collect()
}

#[test]
fn landmarks_tell_a_turned_sphere_which_closest_points_cannot() {
    let fixed = sphere(70.0, Vector::zeros(), 6);
    let turn = movement([0.0, 0.0, 2.0], [0.0; 3]);
    let turned = map(&fixed, |point| turn.apply(point));
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let mut places: Vec<Vector> =
        corners.map(|corner| Vector::from(corner).normalize() * 70.0).to_vec();
    places.push(Vector::new(0.0, 0.0, 70.0));
    let pair = |place: &Vector| LandmarkPair { prediction: *place, actual: turn.apply(place) };
    let named = |(number, place): (usize, &Vector)| (number.to_string(), pair(place));
    let landmarks: BTreeMap<String, LandmarkPair> = places.iter().enumerate().map(named).collect();
    let settings = ComparisonSettings { landmarks, ..ComparisonSettings::default() };
    let found = compared(&fixed, &turned, &settings);
    // Up to the mesh a sphere turned within itself is itself.
    assert!(found.distances.both.unsigned.mean < 0.01);
    let (warped, node_wise) = (found.warped.unwrap(), found.node_wise.unwrap());
    assert_eq!((warped.landmarks, warped.is_affine), (5, false));
    // docs/verification.md#turned-sphere: chords of 2 degrees, by area; 1 % for the mesh.
    for statistics in [warped.area, node_wise.area] {
        for (value, wanted) in [
            (statistics.mean, 1.918_99),
            (statistics.rms, 1.994_98),
            (statistics.median, 2.115_99),
            (statistics.p90, 2.431_09),
            (statistics.p95, 2.440_28),
            (statistics.max, 2.443_34),
        ] {
            assert_near(value, wanted, 0.01 * wanted);
        }
    }
    // The landmark at the pole stays, the others turn on circles of their latitude.
    assert_near(found.landmark_errors["4"].distance, 0.0, 1e-12);
    let chord = 2.0 * 70.0 * (2.0_f64 / 3.0).sqrt() * 1.0_f64.to_radians().sin();
    assert_near(found.landmark_errors["0"].distance, chord, 1e-12);

    let few = settings.landmarks.iter().take(3).map(|(name, pair)| (name.clone(), *pair));
    let few = ComparisonSettings { landmarks: few.collect(), ..ComparisonSettings::default() };
    let found = compared(&fixed, &turned, &few);
    assert_eq!((found.warped, found.landmark_errors.len()), (None, 3));
    assert_eq!(codes(&found.warnings), ["landmarks-insufficient"]);

    let mut doubled = settings;
    doubled.landmarks.insert("again".to_owned(), doubled.landmarks["1"]);
    let found = compared(&fixed, &turned, &doubled);
    assert_eq!(codes(&found.warnings), ["landmarks-insufficient"]);
    let detail = &found.warnings[0].detail;
    assert!(found.warped.is_none() && detail.contains("1 and again are at one place"), "{detail}");
}

#[test]
fn quartiles_and_shares_of_shifted_spheres_are_those_of_a_cosine() {
    let fixed = sphere(70.0, Vector::zeros(), 5);
    let shifted = sphere(70.0, Vector::new(0.0, 0.0, 2.0), 5);
    let edges = vec![-1.0, 0.0, 0.5, 1.0, 1.5];
    let settings = ComparisonSettings { histogram_edges: edges, ..ComparisonSettings::default() };
    let found = compared(&fixed, &shifted, &settings);
    let unsigned = found.distances.both.unsigned;
    for (value, wanted) in [(unsigned.min, 0.0), (unsigned.p25, 0.5), (unsigned.p75, 1.5)] {
        assert_near(value, wanted, 0.02);
    }
    let histograms = found.histograms.unwrap();
    for (share, wanted) in [&histograms.unsigned.shares[..], &[histograms.unsigned.above]]
        .concat()
        .iter()
        .zip([0.0, 0.25, 0.25, 0.25, 0.25])
    {
        assert_near(*share, wanted, 0.01);
    }
    // Signed distances are uniform between -2 and 2.
    let signed =
        [&[histograms.signed.below][..], &histograms.signed.shares, &[histograms.signed.above]]
            .concat();
    for (share, wanted) in signed.iter().zip([0.25, 0.25, 0.125, 0.125, 0.125, 0.125]) {
        assert_near(*share, wanted, 0.01);
    }
    assert_near(signed.iter().sum(), 1.0, 1e-12);
}

#[test]
fn swapped_scans_are_named_with_their_numbers() {
    let at_rest = head(5);
    let displacement: Vec<Vector> = at_rest.points.iter().map(advancement).collect();
    let prediction = map(&at_rest, |point| point + advancement(point));
    let elsewhere = movement([3.0, -2.0, 4.0], [6.0, -5.0, 8.0]);
    let holed = |surface: &TriangleSurface| {
        let mut surface = map(surface, |point| elsewhere.inverse().apply(point));
        surface.triangles.retain(|t| t[0] % 43 != 0);
        surface
    };
    let skull = skull();
    let by_bone = |moving: &TriangleSurface| {
        let moving = map(moving, |point| elsewhere.inverse().apply(point));
        let bones =
            BoneSurfaces { fixed: skull.clone(), moving, mask: None, start: Start::AsItLies };
        Alignment::Surfaces(Box::new(bones))
    };
    let warned = |actual: &TriangleSurface, alignment: Alignment| {
        let settings = ComparisonSettings {
            alignment,
            displacement: Some(displacement.clone()),
            ..ComparisonSettings::default()
        };
        compared(&prediction, actual, &settings).warnings
    };
    // The right scan, before or after it lost some triangles, is not doubted.
    assert_eq!(codes(&warned(&holed(&prediction), by_bone(&skull))), Vec::<&str>::new());
    // Somebody who was operated on a little less is not yet the scan before the operation.
    let less = map(&at_rest, |point| point + advancement(point) * 0.7);
    assert_eq!(codes(&warned(&holed(&less), by_bone(&skull))), Vec::<&str>::new());

    let before = warned(&holed(&at_rest), by_bone(&skull));
    assert_eq!(codes(&before), ["before-operation-suspect"]);
    let [(_, at_rest_mm), (_, predicted_mm)] = before[0].numbers[..] else { panic!() };
    assert!(at_rest_mm < 0.2 && predicted_mm > 1.0, "{before:?}");

    let other = |point: &Vector| Vector::new(point.x * 1.12, point.y * 0.9, point.z * 0.95);
    let others = warned(&holed(&map(&prediction, other)), by_bone(&map(&skull, other)));
    let doubt = others.iter().find(|own| own.code == "another-person-suspect").unwrap();
    assert!(doubt.numbers[0].1 > 0.4, "{others:?}");
    let others = warned(&holed(&map(&prediction, other)), Alignment::ClosestPoint { mask: None });
    assert!(codes(&others).contains(&"another-person-suspect"), "{others:?}");

    let mirror = |point: &Vector| Vector::new(-point.x, point.y, point.z);
    let mirrored = warned(&map(&prediction, mirror), Alignment::ClosestPoint { mask: None });
    assert!(codes(&mirrored).contains(&"mirrored?"), "{mirrored:?}");
}

#[test]
fn two_spheres_that_overlap_have_a_lens_in_common() {
    let one = sphere(10.0, Vector::zeros(), 6);
    let other = sphere(10.0, Vector::new(15.0, 0.0, 0.0), 6);
    let found = overlap(&one, &other).unwrap();
    // docs/verification.md#cuts; flat triangles of 0.2 mm lie up to 0.0005 mm inside, and samples know no border.
    assert_near(found.depth, 5.0, 0.002);
    assert_near(found.volume, 359.974_158, 0.003 * 359.974_158);
    assert_near(found.radius, 6.614_378, 0.03);
    assert!((found.middle - Vector::new(7.5, 0.0, 0.0)).norm() < 0.05, "{}", found.middle);
    assert_eq!(overlap(&one, &sphere(10.0, Vector::new(25.0, 0.0, 0.0), 4)), None);
}
