//! Methods in the spec of a prediction: which settings they become, and what is refused.

use facies::schema::wire::strict;
use facies::schema::{Faults, Limits, PredictDocument, Problem, ResponseDocument};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::prediction::{Method, MethodKind, Settings};
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

#[test]
fn every_method_becomes_the_one_of_its_name_and_auto_linear_finite_elements() {
    let kind = |spec: &str| settings(spec).unwrap().method.kind();
    for method in MethodKind::ALL {
        assert_eq!(kind(&format!(r#"{{"method":"{}"}}"#, method.name())), *method);
    }
    for spec in ["{}", r#"{"method":"auto"}"#] {
        assert_eq!(kind(spec), MethodKind::FemLinear);
    }
}

#[test]
fn a_method_that_there_is_not_is_refused_with_those_that_there_are() {
    for (name, code) in [("fem_ogden", "method-not-available"), ("fem", "unknown-word")] {
        let spec = format!(r#"{{"method":"{name}"}}"#);
        assert_eq!(mistake(&spec), (code.to_owned(), "/method".to_owned()));
        let detail = settings(&spec).unwrap_err().errors[0].detail.clone();
        for known in MethodKind::ALL.iter().map(|method| method.name()).chain(["auto", name]) {
            assert!(detail.contains(&format!("`{known}`")), "{known}: {detail}");
        }
    }
}

#[test]
fn settings_of_a_method_in_the_spec_of_any_other_are_refused() {
    for own in ["msm", "mtm", "dvs", "thickness_warp"] {
        for method in MethodKind::ALL.iter().map(|method| method.name()) {
            let spec = format!(r#"{{"method":"{method}","{own}":{{}}}}"#);
            match method == own {
                true => assert!(settings(&spec).is_ok(), "{spec}"),
                false => {
                    let place = format!("/spec/{own}");
                    assert_eq!(mistake(&spec), ("method-mismatch".to_owned(), place), "{spec}");
                }
            }
        }
    }
}

#[test]
fn a_response_is_usual_if_its_skin_is_that_of_the_case_to_the_usual_tolerance() {
    let unusual = |members: &str| {
        let text = format!(r#"{{"kind":"response","case":"id"{members}}}"#);
        let document: ResponseDocument =
            strict::parse(text.as_bytes(), &Limits::default()).unwrap();
        document.unusual()
    };
    let usual = r#","method":"fem_linear","order":2,"segments":["jaw"],"tolerance":{"relative_residual":1e-9}"#;
    assert_eq!(unusual(usual), [""; 0]);
    assert_eq!(unusual(r#","method":"mtm_ti","membrane":{}"#), ["method", "membrane"]);
    assert_eq!(unusual(r#","tolerance":{"relative_residual":1e-7}"#), ["tolerance"]);
    assert_eq!(unusual(r#","element":"plain","materials":{}"#), ["element", "materials"]);
}
