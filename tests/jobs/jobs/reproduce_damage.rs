//! What is wrong with the scans of an operation that was performed, and which warning tells it.

use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::plan::RigidMovement;
use serde_json::{Value, json};

use super::planning::{moved, performed, result_of, surface};
use crate::sources::Meshes;

fn told(sources: &Meshes, spec: &Value) -> Vec<(String, Value)> {
    let warnings = result_of(sources, spec.clone()).unwrap().warnings;
    let told =
        warnings.into_iter().map(|own| (own.code.clone(), serde_json::to_value(own).unwrap()));
    told.filter(|(code, _)| DOUBTS.contains(&code.as_str())).collect()
}

const DOUBTS: [&str; 6] = [
    "before-operation-suspect",
    "mirrored?",
    "another-person-suspect",
    "segment-misfit",
    "base-unmasked",
    "nothing-performed",
];

fn codes(sources: &Meshes, spec: &Value) -> Vec<String> {
    told(sources, spec).into_iter().map(|(code, _)| code).collect()
}

/// One of the scans with each point taken elsewhere.
fn changed(sources: &Meshes, name: &str, to: impl Fn(&Vector) -> Vector) -> Meshes {
    let mut sources = Meshes(sources.0.clone());
    let own = sources.0[name].surface_in_mm().unwrap();
    let points = own.points.iter().map(to).collect();
    let shape = TriangleSurface { points, ..(*own).clone() };
    sources.0.insert(name.to_owned(), surface(shape));
    sources
}

fn swapped(spec: &Value) -> Value {
    let mut spec = spec.clone();
    spec["before"]["mesh"] = "after".into();
    spec["after"]["mesh"] = "before".into();
    spec
}

#[test]
fn an_operation_as_it_was_performed_raises_no_doubt() {
    let (_, sources, spec) = performed();
    assert_eq!(codes(&sources, &spec), [""; 0]);
}

#[test]
fn scans_in_the_wrong_order_are_reported_by_the_surface_of_a_segment() {
    let (_, sources, spec) = performed();
    let mut swapped = swapped(&spec);
    swapped["base"] = json!({});
    let found = told(&sources, &swapped);
    let (_, warning) = found.iter().find(|(code, _)| code == DOUBTS[0]).expect("a doubt");
    let number = |name: &str| warning[name].as_f64().unwrap();
    // The jaw lies on the scan that it is of, and more than a mm from the other, which is elsewhere and was operated on.
    assert!(number("to_after_mm") < 1e-6 && number("to_before_mm") > 1.0, "{warning}");
}

/// Both scans in the frame of the first, as software hands them over that has registered them.
fn registered(sources: &Meshes) -> Meshes {
    let (done, ..) = performed();
    let mut sources = Meshes(sources.0.clone());
    let bone = sources.0["before"].surface_in_mm().unwrap();
    let jaw = sources.0["jaw"].surface_in_mm().unwrap();
    let mut shape = (*bone).clone();
    let first = shape.points.len() - jaw.points.len();
    shape.points[first..].copy_from_slice(&moved(&jaw, &done).points);
    sources.0.insert("after".to_owned(), surface(shape));
    sources
}

#[test]
fn scans_in_the_wrong_order_are_reported_where_both_lie_in_one_frame() {
    let (_, sources, spec) = performed();
    let sources = registered(&sources);
    assert_eq!(codes(&sources, &spec), [""; 0]);
    assert_eq!(codes(&sources, &swapped(&spec)), [DOUBTS[0]]);
}

#[test]
fn a_segment_that_is_a_part_of_the_scan_is_reported_by_the_plan_that_it_undoes() {
    let (_, sources, mut spec) = performed();
    let sources = registered(&sources);
    spec["segments"] = json!([{"name": "jaw", "mask": {"box_mm": [-50, -50, -60, 150, 100, -9]}}]);
    assert_eq!(codes(&sources, &spec), [""; 0]);
    let spec = swapped(&spec);
    assert_eq!(codes(&sources, &spec), [DOUBTS[0]]);
    let mut unplanned = spec;
    unplanned.as_object_mut().unwrap().remove("planned");
    assert_eq!(codes(&sources, &unplanned), [""; 0], "nothing says which scan was the first");
}

#[test]
fn the_same_scan_twice_is_reported() {
    let (_, sources, mut spec) = performed();
    spec["segments"] = json!([{"name": "jaw", "before": {"mesh": "jaw"}}]);
    spec.as_object_mut().unwrap().remove("planned");
    spec["after"]["mesh"] = "before".into();
    let found = told(&sources, &spec);
    let [(code, warning)] = &found[..] else { panic!("{found:?}") };
    assert_eq!(code, DOUBTS[5]);
    assert!(warning["farthest_mm"].as_f64().unwrap() < 1e-3, "{warning}");
    assert!(warning["detail"].as_str().unwrap().contains("one surface"), "{warning}");
    // Written anew, with other points.
    let again = changed(&sources, "before", |at| at + Vector::repeat(1e-4));
    let mut sources = sources;
    sources.0.insert("again".to_owned(), again.0["before"].clone());
    spec["after"]["mesh"] = "again".into();
    assert_eq!(codes(&sources, &spec), [DOUBTS[5]]);
}

#[test]
fn a_scan_with_its_sides_exchanged_is_reported() {
    let (_, sources, spec) = performed();
    let mirrored = changed(&sources, "after", |at| Vector::new(-at.x, at.y, at.z));
    assert!(codes(&mirrored, &spec).contains(&DOUBTS[1].to_owned()));
}

#[test]
fn a_skull_of_another_size_is_told_to_be_of_somebody_else() {
    let (_, sources, spec) = performed();
    let larger = changed(&sources, "after", |at| at * 1.12);
    assert!(codes(&larger, &spec).contains(&DOUBTS[2].to_owned()));
}

#[test]
fn a_segment_that_is_of_another_bone_is_told_to_fit_nowhere() {
    let (_, sources, spec) = performed();
    let other = changed(&sources, "jaw", |at| Vector::new(at.y * 2.0 - 20.0, at.x, 1.5 * at.z));
    let found = codes(&other, &spec);
    assert_eq!(found, [DOUBTS[3]]);
}

#[test]
fn segments_that_hold_the_same_bone_are_reported_with_their_share() {
    let (_, sources, mut spec) = performed();
    let sources = registered(&sources);
    spec.as_object_mut().unwrap().remove("planned");
    let part = |name: &str, x: [f64; 2]| json!({"name": name, "mask": {"box_mm": [x[0], -50, -60, x[1], 100, -9]}});
    spec["segments"] = json!([part("right", [-50.0, 25.0]), part("left", [25.0, 150.0])]);
    assert_eq!(codes(&sources, &spec), [""; 0], "each has bone of its own");
    spec["segments"] = json!([part("jaw", [-50.0, 150.0]), part("left", [25.0, 150.0])]);
    let found = told(&sources, &spec);
    let [(code, warning)] = &found[..] else { panic!("{found:?}") };
    assert_eq!(code, DOUBTS[3]);
    assert!((warning["share_in_common"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{warning}");
    // The jaw has about half of its bone in common.
    let detail = warning["detail"].as_str().unwrap();
    assert!(detail.contains("100 % of `left`") && detail.contains("% of `jaw`"), "{detail}");
    // A surface of its own beside a mask of the same bone.
    spec["segments"] =
        json!([{"name": "jaw", "before": {"mesh": "jaw"}}, part("left", [25.0, 150.0])]);
    assert_eq!(codes(&sources, &spec), [DOUBTS[3]]);
}

#[test]
fn a_segment_that_fits_only_upside_down_is_reported() {
    let (_, sources, mut spec) = performed();
    let mut sources = registered(&sources);
    let jaw = sources.0["jaw"].surface_in_mm().unwrap();
    let over = RigidMovement::about_pivot(
        Vector::new(0.0, 2.9, 0.0),
        Vector::new(25.0, 10.0, -20.0),
        Vector::zeros(),
    );
    sources.0.insert("over".to_owned(), surface(moved(&jaw, &over)));
    spec.as_object_mut().unwrap().remove("planned");
    spec["segments"] = json!([{"name": "jaw", "before": {"mesh": "jaw"}, "after": {"mesh": "over"}, "start": "inertia"}]);
    let found = told(&sources, &spec);
    let [(code, warning)] = &found[..] else { panic!("{found:?}") };
    assert_eq!(code, DOUBTS[3]);
    let turned = warning["turned_deg"].as_f64().unwrap();
    assert!((turned - 2.9_f64.to_degrees()).abs() < 0.1, "{warning}");
}
