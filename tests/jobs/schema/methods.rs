//! Methods in the spec of a prediction: which settings they become, and what is refused.

use facies::schema::wire::strict;
use facies::schema::{Faults, Limits, PredictDocument, Problem};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::prediction::{Method, Settings};
use mechanics::solver::stationary::{Iteration, Stationary};

fn plain(iteration: Iteration) -> Stationary {
    Stationary { iteration, relative_change: None, most_iterations: 50_000 }
}

/// The settings of a spec, or why they are refused.
fn settings(spec: &str) -> Result<Settings, Problem> {
    let document: PredictDocument = strict::parse(spec.as_bytes(), &Limits::default())?;
    let mut faults = Faults::default();
    let settings = document.to_settings(&Limits::default(), &mut faults);
    faults.into_result().map(|()| settings)
}

/// Code and place of the only mistake.
fn mistake(spec: &str) -> (String, String) {
    let problem = settings(spec).expect_err("refused");
    assert_eq!(problem.errors.len(), 1, "{}", problem.detail);
    (problem.errors[0].code.name().to_owned(), problem.errors[0].pointer.clone())
}

#[test]
fn the_spec_tells_how_rest_is_found() {
    let method = |spec: &str| settings(spec).unwrap().method;
    let of = |search, most_iterations| {
        Method::MassSpring(MassSpringSettings { search, most_iterations })
    };
    assert_eq!(method(r#"{"method":"msm"}"#), of(Search::Newton, 500));
    assert_eq!(
        method(r#"{"method":"msm","msm":{"equilibrium":"direct"}}"#),
        of(Search::Direct, 50_000)
    );
    assert_eq!(method(r#"{"method":"msm","msm":{"max_iterations":9}}"#), of(Search::Newton, 9));
    let at = |code: &str, pointer: &str| (code.to_owned(), pointer.to_owned());
    let none = mistake(r#"{"method":"msm","msm":{"max_iterations":0}}"#);
    assert_eq!(none, at("out-of-range", "/spec/msm/max_iterations"));
    for other in [r#"{"msm":{}}"#, r#"{"method":"mtm","msm":{}}"#] {
        assert_eq!(mistake(other), at("method-mismatch", "/spec/msm"), "{other}");
    }
}

#[test]
fn the_spec_tells_what_brings_the_tensors_to_rest() {
    let method = |spec: &str| settings(spec).unwrap().method;
    let of = |iterations| Method::MassTensor(MassTensorSettings { iterations });
    assert_eq!(method(r#"{"method":"mtm"}"#), of(Iterations::Fast));
    for (name, iteration) in [
        ("gauss_seidel", Iteration::GaussSeidel),
        ("damped_jacobi", Iteration::DampedJacobi),
        ("jacobi", Iteration::Jacobi),
    ] {
        let spec = format!(r#"{{"method":"mtm","mtm":{{"iterations":"{name}"}}}}"#);
        assert_eq!(method(&spec), of(Iterations::Stationary(plain(iteration))));
    }
    let spec = r#"{"method":"mtm","mtm":{"iterations":"jacobi","relative_change":1e-9,"max_iterations":7}}"#;
    let stated = Stationary {
        iteration: Iteration::Jacobi,
        relative_change: Some(1e-9),
        most_iterations: 7,
    };
    assert_eq!(method(spec), of(Iterations::Stationary(stated)));
    for (spec, code, pointer) in [
        (r#"{"mtm":{}}"#, "method-mismatch", "/spec/mtm"),
        (
            r#"{"method":"mtm","mtm":{"max_iterations":5}}"#,
            "method-mismatch",
            "/spec/mtm/max_iterations",
        ),
        (
            r#"{"method":"mtm","mtm":{"iterations":"gauss_seidel","relative_change":1}}"#,
            "out-of-range",
            "/spec/mtm/relative_change",
        ),
    ] {
        assert_eq!(mistake(spec), (code.to_owned(), pointer.to_owned()));
    }
}

/// Every method that documents may ask for, so that a new one is not forgotten in the table of golden numbers.
#[test]
fn every_method_that_is_built_has_golden_numbers() {
    let table = include_str!("../../../mechanics/tests/mechanics/golden/golden.txt");
    let has = |begin: &str| table.lines().any(|line| line.starts_with(begin));
    for method in facies::schema::methods::available_methods().methods {
        let name = method.method.name.name();
        assert!(has(&format!("{name} ")) || has(&format!("{name}:")), "{name} has no line");
    }
    for kind in ["response", "optimise", "comparison", "study"] {
        assert!(has(kind), "{kind} has no line");
    }
}
