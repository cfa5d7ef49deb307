//! Muscles in documents: bodies, boxes and their tissue, what a check tells of them, and what is refused where.

use std::collections::BTreeMap;

use facies::jobs::{JobError, PredictInput, StoredMesh, StoredShape, check};
use facies::schema::Limits;
use facies::schema::case::muscle_mixing::MixingRuleName;
use facies::schema::predict::check::CheckDocument;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector};
use mechanics::muscle::strap::box_surface;
use mechanics::progress::StopQuery;
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

/// A strap of 40 x 10 x 5 mm along x, in the middle of the block.
fn strap() -> TriangleSurface {
    let half = [(0, 20.0), (1, 5.0), (2, 2.5)].map(|(axis, size)| Vector::ith(axis, size));
    box_surface(Vector::new(40.0, 30.0, 20.0), half)
}

fn input(case: &Value, spec: Value) -> (PredictInput, Meshes) {
    let volume = block(Vector::new(80.0, 60.0, 40.0), [16, 12, 8], CellShape::Hex8);
    let surface = |own: TriangleSurface| StoredMesh {
        frame: None,
        ..stored(StoredShape::Surface(own.into()), None)
    };
    let meshes = Meshes(BTreeMap::from([
        ("block".to_owned(), stored(StoredShape::Volume(volume.into()), None)),
        ("strap".to_owned(), surface(strap())),
    ]));
    let mut whole = json!({
        "units": "mm", "volume": "block", "fixed": [{"node_set": "z_min"}],
        "segments": [{"name": "left", "nodes": {"node_set": "x_min"}}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.45}}
    });
    whole.as_object_mut().unwrap().extend(case.as_object().unwrap().clone());
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(whole).unwrap(),
        plan: serde_json::from_value(json!({})).unwrap(),
        spec: serde_json::from_value(spec).unwrap(),
    };
    (input, meshes)
}

fn checked(case: &Value) -> CheckDocument {
    let (input, meshes) = input(case, json!({}));
    check(&input, &meshes, &Limits::default(), &StopQuery::never()).unwrap().document
}

/// The place, the code and the words of the first thing that is wrong.
fn refused(muscle: &Value) -> (String, String, String) {
    let (input, meshes) = input(&json!({"muscles": [muscle]}), json!({}));
    let Err(error) = check(&input, &meshes, &Limits::default(), &StopQuery::never()) else {
        panic!("taken: {muscle}")
    };
    let JobError::Refused(problem) = error else { panic!("{error:?}") };
    let first = &problem.errors[0];
    (first.pointer.to_string(), first.code.name().to_owned(), first.detail.clone())
}

fn fibred() -> Value {
    json!({"young_modulus_kpa": 60, "poisson_ratio": 0.45, "fibre": {"young_modulus_kpa": 300}})
}

#[test]
fn a_check_tells_how_much_of_the_cells_is_muscle_and_where_the_rule_decides() {
    let case = json!({
        "muscles": [
            {"name": "body", "surface": "strap", "material": fibred()},
            {"name": "box", "box_mm": {"centre": [40, 10, 20],
                "half_axes": [[20, 0, 0], [0, 5, 0], [0, 0, 2.5]]}},
            {"name": "line", "lines_mm": [[[10, 50, 20], [70, 50, 20]]], "within_mm": 8}],
        "muscle_mixing": {"rule": "reuss", "samples": 512}});
    let told = checked(&case).muscles.unwrap();
    let body = &told.muscles["body"];
    assert!((body.enclosed_mm3.unwrap() - 2000.0).abs() < 1e-9, "{body:?}");
    assert!((body.volume_mm3 / 2000.0 - 1.0).abs() < 0.01, "{body:?}");
    assert!(body.broadness.unwrap() < 0.4 && told.muscles["box"].broadness == body.broadness);
    // pi r² L / 3, and what is beyond the ends.
    let line = &told.muscles["line"];
    assert!(line.enclosed_mm3.is_none() && line.volume_mm3 > 4000.0, "{line:?}");
    let tissue = told.tissue.unwrap();
    assert_eq!((tissue.rule, tissue.cells), (MixingRuleName::Reuss, body.cells));
    // The strap is half as thick as the two layers of cells that it lies in.
    assert_eq!(tissue.mixed_cells, tissue.cells, "{tissue:?}");
    assert!(tissue.rule_decides_share > 0.0 && tissue.crossing_cells == 0, "{tissue:?}");
    assert!(checked(&json!({})).muscles.is_none());
    let plain = json!({"muscles": [{"name": "body", "surface": "strap"}]});
    assert!(checked(&plain).muscles.unwrap().tissue.is_none());
}

#[test]
fn what_is_wrong_with_a_body_is_reported_with_its_place() {
    let at = |muscle: Value| {
        let mut whole = json!({"name": "m"});
        whole.as_object_mut().unwrap().extend(muscle.as_object().unwrap().clone());
        let (pointer, code, _) = refused(&whole);
        format!("{pointer} {code}")
    };
    let box_of =
        |c: [f64; 3]| json!({"centre": [40, 30, 20], "half_axes": [[20, 0, 0], [0, 5, 0], c]});
    for (muscle, known) in [
        (json!({"surface": "nobody"}), "/case/muscles/0/surface unknown-mesh"),
        (
            json!({"box_mm": box_of([0.0, 1.0, 0.0])}),
            "/case/muscles/0/box_mm/half_axes out-of-range",
        ),
        (json!({"surface": "strap", "box_mm": box_of([0.0, 0.0, 1.0])}), "/case/muscles/0 one-of"),
        (json!({"surface": "strap", "within_mm": 3}), "/case/muscles/0/within_mm unknown-field"),
        (json!({"surface": "strap", "boxes": 3}), "/case/muscles/0/boxes out-of-range"),
        (json!({"surface": "strap", "boxes": 2, "direction": [1, 0, 0]}), "/case/muscles/0 one-of"),
        (
            json!({"region": "tissue", "direction": [1, 0, 0], "material": fibred()}),
            "/case/muscles/0/material unknown-field",
        ),
        (
            json!({"surface": "strap", "material": {"young_modulus_kpa": 60}}),
            "/case/muscles/0/material/poisson_ratio missing-field",
        ),
        (
            json!({"surface": "strap", "material": {"young_modulus_kpa": 6, "poisson_ratio": 0.4,
                "fibre": {"young_modulus_kpa": 9, "direction": [1, 0, 0]}}}),
            "/case/muscles/0/material/fibre/direction method-not-available",
        ),
        (
            json!({"surface": "strap", "material": {"young_modulus_kpa": 6, "poisson_ratio": 0.4,
                "law": {"kind": "neo_hookean"}}}),
            "/case/muscles/0/material/law method-not-available",
        ),
        (
            json!({"surface": "strap", "stiffening": {"young_modulus_kpa": 200, "stress_kpa": 9}}),
            "/case/muscles/0/stiffening missing-field",
        ),
        (
            json!({"surface": "strap", "material": fibred(),
                "stiffening": {"young_modulus_kpa": 100, "stress_kpa": 9}}),
            "/case/muscles/0/stiffening/young_modulus_kpa out-of-range",
        ),
    ] {
        assert_eq!(at(muscle.clone()), known, "{muscle}");
    }
}
