//! A prediction whose mesh is refined: its result stands at the nodes of the case, and mistakes are told before anything is solved.

use facies::jobs::check;
use facies::schema::{Limits, Problem};
use mechanics::progress::StopQuery;

use super::results::{meshes, predict, predict_input};

/// A segment under one half of a block, so that the skin is off where the other half begins.
const CASE: &str = r#"{"units":"mm","volume":"block","skin":{"node_set":"z_max"},
    "skin_regions":{"left":{"node_set":"x_min"}},
    "segments":[{"name":"end","nodes":{"node_set":"x_max"}}],"fixed":[{"node_set":"z_min"}],
    "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.4}}}"#;
const PULL: &str = r#"{"segments":[{"name":"end","translation_mm":[0,0,4]}]}"#;

fn refused(case: &str, spec: &str) -> Problem {
    let out = tempfile::tempdir().unwrap();
    match predict(case, PULL, spec, out.path()) {
        Err(facies::jobs::JobError::Refused(problem)) => problem,
        other => panic!("{:?}", other.map(|_| ())),
    }
}

#[test]
fn a_refined_prediction_tells_its_meshes_and_keeps_the_nodes_of_the_case() {
    let out = tempfile::tempdir().unwrap();
    let plain = predict(CASE, PULL, "{}", out.path()).unwrap().result;
    assert!(plain.refinement.is_none());
    let before = plain.numerical_error_mm.unwrap().mean;
    let spec = format!(
        r#"{{"refine":{{"accept_mm":{},"regions":{{"left":50}}}},"outputs":["skin.csv"]}}"#,
        0.5 * before
    );
    let out = tempfile::tempdir().unwrap();
    let refined = predict(CASE, PULL, &spec, out.path()).unwrap().result;
    let told = refined.refinement.unwrap();
    assert!(told.met && told.stopped == "met" && told.levels.len() > 1);
    // Means of levels are over the skin that moves, which is off by more than all of it.
    assert!(told.levels[0].mean_mm > before);
    let last = told.levels.last().unwrap();
    assert!(refined.numerical_error_mm.unwrap().mean < last.mean_mm);
    assert!(last.mean_mm <= 0.5 * before && last.regions_mm["left"] <= 50.0);
    assert_eq!(refined.provenance.solver.unwrap().unknowns, last.unknowns);
    let rows = std::fs::read_to_string(out.path().join("skin.csv")).unwrap().lines().count();
    // The 5 x 4 nodes of the top of the case, and a line of names.
    assert_eq!(rows, 21);
}

#[test]
fn a_bound_that_comes_first_is_reported() {
    let out = tempfile::tempdir().unwrap();
    let spec = r#"{"refine":{"accept_mm":0.001,"cells":1000}}"#;
    let result = predict(CASE, PULL, spec, out.path()).unwrap().result;
    let told = result.refinement.unwrap();
    assert!(!told.met && told.stopped == "cells");
    assert!(!told.levels.is_empty() && told.levels.iter().all(|level| level.cells <= 1000));
    assert!(result.warnings.iter().any(|warning| warning.code == "tolerance-not-met"));
    let input = predict_input(CASE, PULL, spec);
    let checked =
        check(&input, &meshes(), &Limits::default(), &StopQuery::never()).unwrap().document;
    let bound = checked.refine.unwrap();
    assert!(bound.cells == 1000 && bound.memory_mb > 30.0);
    // No other model is chosen, before and after.
    assert!(checked.auto.is_none() && checked.why.contains("refined"), "{}", checked.why);
    assert_eq!(result.provenance.why, Some(checked.why));
}

#[test]
fn what_cannot_be_refined_is_refused_with_its_place() {
    let lips = refused(CASE, r#"{"refine":{"accept_mm":0.1,"regions":{"lips":0.1}}}"#);
    assert_eq!(lips.errors[0].pointer, "/spec/refine/regions/lips");
    assert_eq!(lips.errors[0].code.name(), "unknown-region");
    let landmarks = r#""landmarks":{"below":[0,0,-7]},"skin":"#;
    let landmarks = CASE.replace(r#""skin":"#, landmarks);
    for (name, code) in [("nose", "unknown-landmark"), ("below", "out-of-range")] {
        let spec = format!(r#"{{"refine":{{"accept_mm":0.1,"landmarks":{{"{name}":0.1}}}}}}"#);
        let problem = refused(&landmarks, &spec);
        assert_eq!(problem.errors[0].pointer, format!("/spec/refine/landmarks/{name}"));
        assert_eq!(problem.errors[0].code.name(), code);
    }
    let bricks = CASE.replace(r#""volume":"block""#, r#""volume":"bricks""#);
    let bricks = refused(&bricks, r#"{"refine":{"accept_mm":0.1}}"#);
    assert_eq!(bricks.errors[0].pointer, "/spec/refine");
    assert!(bricks.detail.contains("24 of 24 cells are hexahedra or wedges"), "{}", bricks.detail);
    for (spec, code) in [
        (r#"{"refine":{"accept_mm":0.1},"method":"fem_nonlinear"}"#, "method-mismatch"),
        (r#"{"refine":{"accept_mm":0.1},"accept_mm":0.1}"#, "one-of"),
        (r#"{"refine":{"accept_mm":0.1},"accept_regions_mm":{"left":0.1}}"#, "one-of"),
        (r#"{"refine":{"accept_mm":0.1},"estimate":"none"}"#, "one-of"),
        (r#"{"refine":{"accept_mm":0.1},"element":"quadratic"}"#, "one-of"),
    ] {
        let problem = refused(CASE, spec);
        assert_eq!(problem.errors[0].pointer, "/spec/refine", "{spec}");
        assert_eq!(problem.errors[0].code.name(), code, "{spec}");
    }
    let negative = refused(CASE, r#"{"refine":{"accept_mm":-1}}"#);
    assert_eq!(negative.errors[0].pointer, "/spec/refine/accept_mm");
}
