//! Load steps, asked for in documents.

use std::collections::BTreeMap;

use facies::jobs::{JobContext, JobInput, PredictInput, StoredMesh, StoredShape, check, work};
use facies::schema::Limits;
use facies::schema::predict::result::ResultDocument;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::progress::{StopQuery, Unobserved};
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

fn sources() -> Meshes {
    let volume = block(Vector::new(30.0, 20.0, 10.0), [6, 4, 2], CellShape::Hex8);
    let volume = StoredMesh { frame: None, ..stored(StoredShape::Volume(volume.into()), None) };
    Meshes(BTreeMap::from([("block".to_owned(), volume)]))
}

fn asked(spec: Value) -> PredictInput {
    let case = json!({
        "units": "mm", "volume": "block", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "x_min"}],
        "segments": [{"name": "jaw", "nodes": {"node_set": "x_max"}}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.45}}
    });
    let plan = json!({"segments": [{"name": "jaw", "translation_mm": [1, 0, 4]}]});
    PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case).unwrap(),
        plan: serde_json::from_value(plan).unwrap(),
        spec: serde_json::from_value(spec).unwrap(),
    }
}

fn predicted(own: Value) -> ResultDocument {
    let input =
        asked(json!({"outputs": ["skin.vtp"], "method": "fem_nonlinear", "fem_nonlinear": own}));
    let folder = tempfile::tempdir().unwrap();
    let (limits, sources) = (Limits::default(), sources());
    let place = JobContext { sources: &sources, limits: &limits, out: folder.path() };
    work(&JobInput::Predict(input), &place, &Unobserved).unwrap().result
}

#[test]
fn a_result_has_a_row_for_each_load_step_and_the_answer_without_them() {
    let (stepped, at_once) = (predicted(json!({"load_steps": 3})), predicted(json!({})));
    let shares: Vec<f64> = stepped.load_steps.iter().map(|step| step.rest.share).collect();
    assert_eq!(shares, [1.0 / 3.0, 2.0 / 3.0, 1.0]);
    let solver = |result: &ResultDocument| result.provenance.solver.clone().unwrap();
    let steps: u64 = stepped.load_steps.iter().map(|step| step.rest.steps).sum();
    assert_eq!(steps, solver(&stepped).iterations);
    let last = stepped.load_steps.last().unwrap();
    assert_eq!(last.reaction_millinewton, stepped.reaction_millinewton);
    let newton = solver(&stepped).newton.unwrap();
    assert_eq!(
        (last.rest.energy_mn_mm, last.rest.least_det_f),
        (newton.energy_mn_mm, newton.least_det_f)
    );
    assert_eq!(
        (last.bulk_in_cells, last.cells_with_bulk),
        (newton.bulk_in_cells, newton.cells_with_bulk)
    );
    assert!(stepped.load_steps.iter().all(|step| step.warnings.is_empty()));
    assert!(
        stepped
            .load_steps
            .iter()
            .all(|step| step.relative_residual <= 1e-8 && step.is_stable == Some(true))
    );
    // By the square of the share, as far as tissue is linear.
    let first = &stepped.load_steps[0];
    let ratio = last.rest.energy_mn_mm / first.rest.energy_mn_mm;
    assert!((8.0..10.0).contains(&ratio), "{ratio}");
    assert!(at_once.load_steps.is_empty());
    let mean = |of: &ResultDocument| of.statistics.as_ref().unwrap().skin.nodes.mean;
    assert!(
        (mean(&stepped) - mean(&at_once)).abs() < 1e-6,
        "{} {}",
        mean(&stepped),
        mean(&at_once)
    );
}

#[test]
fn load_steps_that_are_too_many_or_of_another_method_are_refused_with_their_place() {
    for (spec, pointer, code) in [
        (
            json!({"method": "fem_nonlinear", "fem_nonlinear": {"load_steps": 0}}),
            "/spec/fem_nonlinear/load_steps",
            "out-of-range",
        ),
        (
            json!({"method": "fem_nonlinear", "fem_nonlinear": {"load_steps": 101}}),
            "/spec/fem_nonlinear/load_steps",
            "out-of-range",
        ),
        (
            json!({"method": "fem_linear", "fem_nonlinear": {"load_steps": 4}}),
            "/spec/fem_nonlinear",
            "method-mismatch",
        ),
    ] {
        let ended =
            check(&asked(spec.clone()), &sources(), &Limits::default(), &StopQuery::never());
        let refused = ended.err().expect("it is refused");
        let facies::jobs::JobError::Refused(problem) = refused else { panic!("{spec}: {refused}") };
        let told = &problem.errors[0];
        assert_eq!(
            (told.pointer.as_str(), told.code.name()),
            (pointer, code),
            "{spec}: {}",
            told.detail
        );
        if code == "out-of-range" {
            assert!(told.detail.contains('1') && told.detail.contains("100"), "{}", told.detail);
        }
    }
}

#[test]
fn load_steps_are_made_with_contact_and_are_a_table_of_the_report() {
    let spec = json!({
        "outputs": ["skin.vtp", "report.html"], "method": "fem_nonlinear", "contact": "unilateral",
        "fem_nonlinear": {"load_steps": 3}
    });
    let folder = tempfile::tempdir().unwrap();
    let (limits, sources) = (Limits::default(), sources());
    let place = JobContext { sources: &sources, limits: &limits, out: folder.path() };
    let result = work(&JobInput::Predict(asked(spec)), &place, &Unobserved).unwrap().result;
    // Nothing of one block meets anything.
    assert_eq!(result.load_steps.len(), 3);
    assert!(result.load_steps.iter().all(|step| step.contact.is_none()));
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    for words in ["<h2>Load steps</h2>", "33.3 %", "66.7 %", "100.0 %"] {
        assert!(html.contains(words), "{words}");
    }
}

#[test]
fn each_load_step_is_expected_to_take_its_time() {
    let expected = |own: Value| {
        let input = asked(json!({"method": "fem_nonlinear", "fem_nonlinear": own}));
        let told =
            check(&input, &sources(), &Limits::default(), &StopQuery::never()).unwrap().document;
        told.time_s.unwrap()
    };
    let (one, ten) = (expected(json!({})), expected(json!({"load_steps": 10})));
    assert!(
        (ten.low / one.low - 10.0 / 3.0).abs() < 1e-9 && (ten.high / one.high - 10.0).abs() < 1e-9
    );
}
