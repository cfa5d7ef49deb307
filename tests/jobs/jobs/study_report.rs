//! The outcome of a study and its files, on reports made by hand.

use facies::jobs::study::files::{COLUMNS, csv, junit};
use facies::jobs::study::verdict::{Baseline, judge};
use facies::jobs::study::{chart, estimates_chart};
use facies::schema::ReportDocument;
use facies::schema::study::report::{OutcomeName, RowVerdict};
use serde_json::{Value, json};

/// A row with numbers.
fn solved(label: &str, level: u32, [wall_s, p95]: [f64; 2]) -> Value {
    let errors = json!({"mean": p95 / 2.0, "p95": p95, "max": 2.0 * p95});
    json!({
        "scene": "slab", "plan": "4 mm", "method": "fem_linear", "label": label, "element": "tet4",
        "material": "case", "level": level, "status": "solved", "unknowns": 100, "iterations": 5,
        "wall_s": wall_s, "repeats": 1, "mean_mm": p95 / 2.0, "p95_mm": p95, "max_mm": 2.0 * p95,
        "closest_point_mm": errors, "regions_mm": {}, "skin_mean_mm": 1.0, "on_front": true,
        "verdict": "not-run",
    })
}

/// A row without.
fn failed(label: &str, status: &str, kind: &str) -> Value {
    json!({
        "scene": "slab", "plan": "4 mm", "method": "msm", "label": label, "element": "",
        "material": "case", "level": 0, "status": status, "on_front": false, "verdict": "not-run",
        "error": {"type": kind, "detail": "it <did> & \"more\""},
    })
}

fn report(rows: &[Value], rules: Value) -> ReportDocument {
    serde_json::from_value(json!({
        "schema": 1, "job": "first", "spec_hash": "", "created": "", "statement": "",
        "engine": {"name": "", "version": "", "target": "", "profile": ""},
        "verdict": {"outcome": "incomplete", "reasons": [], "rows": 0, "solved": 0, "failed": 0, "worse": 0, "not_run": 0},
        "rules": rules, "scenes": [], "rows": rows, "comparisons": [], "convergence": [],
    }))
    .unwrap()
}

fn usual() -> Value {
    json!({"tolerances": {}, "expected_failures": []})
}

fn judged(rows: &[Value], rules: Value, baseline: &Baseline) -> ReportDocument {
    let mut report = report(rows, rules);
    judge(&mut report, baseline);
    report
}

fn outcome(rows: &[Value], rules: Value, baseline: &Baseline) -> OutcomeName {
    judged(rows, rules, baseline).verdict.outcome
}

#[test]
fn an_empty_study_and_one_without_numbers_are_never_green() {
    let none = Baseline::NotAsked;
    assert_eq!(outcome(&[], usual(), &none), OutcomeName::Incomplete);
    let rules = json!({"tolerances": {}, "expected_failures": ["msm"]});
    let only_failures = [failed("msm", "failed", "solver-diverged")];
    assert_eq!(outcome(&only_failures, rules, &none), OutcomeName::Incomplete);
    let rows = [solved("fem", 0, [1.0, 0.1]), failed("msm", "not-run", "not-run")];
    assert_eq!(outcome(&rows, usual(), &none), OutcomeName::Incomplete);
    assert_eq!(outcome(&rows[..1], usual(), &none), OutcomeName::Pass);
}

#[test]
fn a_failure_is_worse_unless_it_may_be_or_was_there_before() {
    let rows = [solved("fem", 0, [1.0, 0.1]), failed("msm", "failed", "solver-diverged")];
    assert_eq!(outcome(&rows, usual(), &Baseline::NotAsked), OutcomeName::Worse);
    let expected = json!({"tolerances": {}, "expected_failures": ["msm"]});
    assert_eq!(outcome(&rows, expected, &Baseline::NotAsked), OutcomeName::Pass);
    let before = report(&rows, usual());
    let now = judged(&rows, usual(), &Baseline::Report(&before));
    assert_eq!(
        (now.verdict.outcome, now.rows[1].verdict),
        (OutcomeName::Pass, RowVerdict::KnownFailure)
    );
    let otherwise = [rows[0].clone(), failed("msm", "failed", "matrix-singular")];
    assert_eq!(outcome(&otherwise, usual(), &Baseline::Report(&before)), OutcomeName::Worse);
    let solved_before = report(&[rows[0].clone(), solved("msm", 0, [1.0, 0.5])], usual());
    let now = judged(&rows, usual(), &Baseline::Report(&solved_before));
    assert_eq!(now.verdict.outcome, OutcomeName::Worse);
    assert!(now.rows[1].reasons[0].starts_with("solved in the baseline, now solver-diverged"));
}

#[test]
fn rows_may_grow_by_their_ratio_and_by_what_is_only_noise() {
    let before = report(&[solved("fem", 0, [1.0, 0.1])], usual());
    let against = |row: [f64; 2], rules: Value| {
        outcome(&[solved("fem", 0, row)], rules, &Baseline::Report(&before))
    };
    assert_eq!(against([1.4, 0.104], usual()), OutcomeName::Pass);
    assert_eq!(against([1.4, 0.106], usual()), OutcomeName::Worse);
    let ratios = |ratios: Value| json!({"tolerances": ratios, "expected_failures": []});
    // Time is judged by who asks for it only.
    assert_eq!(against([100.0, 0.104], usual()), OutcomeName::Pass);
    assert_eq!(against([1.6, 0.104], ratios(json!({"wall_ratio": 1.5}))), OutcomeName::Worse);
    let wide = ratios(json!({"p95_ratio": 1.2, "wall_ratio": 3.0}));
    assert_eq!(against([2.5, 0.115], wide), OutcomeName::Pass);
    let of_iterations = |count: u64, rules: Value| {
        let mut row = solved("fem", 0, [1.0, 0.1]);
        row["iterations"] = json!(count);
        judged(&[row], rules, &Baseline::Report(&before))
    };
    // From 5: five more are none, whatever the ratio says.
    assert_eq!(of_iterations(10, usual()).verdict.outcome, OutcomeName::Pass);
    let more = of_iterations(11, usual());
    assert_eq!(
        more.rows[0].reasons,
        ["iterations 11 is 2.20 times the 5 of the baseline, 1.5 are allowed"]
    );
    let twice = ratios(json!({"iterations_ratio": 2.5}));
    assert_eq!(of_iterations(11, twice).verdict.outcome, OutcomeName::Pass);
    // Solutions agree to 1e-4 mm, and a clock in a busy machine to some ms.
    let tiny = report(&[solved("fem", 0, [1e-3, 1e-6])], usual());
    let timed = || ratios(json!({"wall_ratio": 1.5}));
    let noise = [solved("fem", 0, [0.015, 9e-5])];
    assert_eq!(outcome(&noise, timed(), &Baseline::Report(&tiny)), OutcomeName::Pass);
    let more = [solved("fem", 0, [0.03, 9e-5])];
    assert_eq!(outcome(&more, timed(), &Baseline::Report(&tiny)), OutcomeName::Worse);
}

/// With a variant that does not serve the scene.
fn with_skipped(rows: &[Value], rules: Value, label: &str) -> ReportDocument {
    let mut report = report(rows, rules);
    let skipped = json!([{"scene": "slab", "method": "fem_linear", "label": label, "rows": 2, "reason": "it <is> not"}]);
    report.skipped = serde_json::from_value(skipped).unwrap();
    report
}

#[test]
fn what_does_not_apply_judges_nothing_and_is_listed() {
    let rows = [solved("fem", 0, [1.0, 0.1])];
    let judged = |rules: Value, baseline: &Baseline| {
        let mut report = with_skipped(&rows, rules, "quadratic");
        judge(&mut report, baseline);
        report
    };
    let alone = judged(usual(), &Baseline::NotAsked);
    assert_eq!((alone.verdict.outcome, alone.verdict.skipped), (OutcomeName::Pass, 2));
    let text = junit(&alone);
    assert!(
        text.contains("name=\"quadratic\" time=\"0\"><skipped message=\"it &lt;is&gt; not\"/>")
    );
    assert!(text.contains("tests=\"3\" failures=\"0\" errors=\"0\" skipped=\"1\""), "{text}");

    // Baselines of earlier programs have a row that failed for it: nothing is lost. One that was solved there is.
    let mut of_before = failed("quadratic", "failed", "method-not-available");
    of_before["method"] = json!("fem_linear");
    let before = report(&[rows[0].clone(), of_before], usual());
    let held = judged(usual(), &Baseline::Report(&before));
    assert_eq!(held.verdict.outcome, OutcomeName::Pass, "{:?}", held.verdict.reasons);
    let before = report(&[rows[0].clone(), solved("quadratic", 0, [1.0, 0.1])], usual());
    let held = judged(usual(), &Baseline::Report(&before));
    assert_eq!(held.verdict.outcome, OutcomeName::Incomplete);

    // Thresholds that hold for nothing else have not been kept.
    let bounds = json!({"p95_mm": 1.0, "labels": ["quadratic"]});
    let rules = json!({"tolerances": {}, "expected_failures": [], "thresholds": bounds});
    let held = judged(rules, &Baseline::NotAsked);
    assert_eq!(held.verdict.outcome, OutcomeName::Incomplete);
    assert_eq!(held.verdict.reasons, ["the thresholds are for quadratic, which applies nowhere"]);
    let mut nothing = with_skipped(&[], usual(), "quadratic");
    judge(&mut nothing, &Baseline::NotAsked);
    assert_eq!(nothing.verdict.outcome, OutcomeName::Incomplete);
}

#[test]
fn thresholds_hold_for_the_labels_they_name() {
    let rows = [solved("fem", 0, [1.0, 0.1]), solved("msm", 0, [1.0, 2.0])];
    let rules =
        |bounds: Value| json!({"tolerances": {}, "expected_failures": [], "thresholds": bounds});
    let none = Baseline::NotAsked;
    assert_eq!(outcome(&rows, rules(json!({"p95_mm": 1.0})), &none), OutcomeName::Worse);
    let of_fem = json!({"p95_mm": 1.0, "labels": ["fem"]});
    assert_eq!(outcome(&rows, rules(of_fem), &none), OutcomeName::Pass);
    assert_eq!(outcome(&rows, rules(json!({"wall_s": 0.5})), &none), OutcomeName::Worse);
    assert_eq!(outcome(&rows, rules(json!({"mean_mm": 1.0})), &none), OutcomeName::Pass);
}

#[test]
fn a_baseline_that_says_nothing_of_these_rows_is_none_and_lost_rows_are_reported() {
    let rows = [solved("fem", 0, [1.0, 0.1])];
    let missing = Baseline::Missing("it is gone".to_owned());
    assert_eq!(outcome(&rows, usual(), &missing), OutcomeName::NoBaseline);
    let other = report(&[solved("fem", 1, [1.0, 0.1])], usual());
    assert_eq!(outcome(&rows, usual(), &Baseline::Report(&other)), OutcomeName::NoBaseline);
    let more = report(&[rows[0].clone(), solved("fem", 1, [1.0, 0.1])], usual());
    let now = judged(&rows, usual(), &Baseline::Report(&more));
    assert_eq!(now.verdict.outcome, OutcomeName::Incomplete);
    assert_eq!(now.verdict.reasons, ["1 rows of the baseline are not in this study"]);
    let codes =
        [OutcomeName::Pass, OutcomeName::Worse, OutcomeName::Incomplete, OutcomeName::NoBaseline];
    assert_eq!(codes.map(OutcomeName::exit_code), [0, 1, 4, 5]);
}

#[test]
fn a_plan_that_moves_nothing_passes_no_gate() {
    let mut row = solved("fem", 0, [1.0, 0.0]);
    row["warnings"] = json!(["nothing-moves"]);
    let report = judged(&[row], usual(), &Baseline::NotAsked);
    assert_eq!(report.verdict.outcome, OutcomeName::Worse);
    assert!(report.rows[0].reasons[0].contains("moves nothing"), "{:?}", report.rows[0].reasons);
}

#[test]
fn a_baseline_of_another_mesh_or_truth_or_without_numbers_is_reported() {
    let rows = [solved("fem", 0, [1.0, 0.1])];
    let of = |nodes: u64, truth: &str| {
        let mut report = report(&rows, usual());
        let scene = json!({
            "name": "slab", "nodes": nodes, "cells": 80, "skin_nodes": 25, "truth": truth, "truth_s": 0.1,
        });
        report.scenes = vec![serde_json::from_value(scene).unwrap()];
        report
    };
    let against = |before: &ReportDocument| {
        let mut now = of(100, "refined");
        judge(&mut now, &Baseline::Report(before));
        now.verdict
    };
    assert_eq!(against(&of(100, "refined")).outcome, OutcomeName::Pass);
    for other in [of(125, "refined"), of(100, "quadratic")] {
        let verdict = against(&other);
        assert_eq!(verdict.outcome, OutcomeName::Incomplete);
        assert!(verdict.reasons[0].contains("\"slab\" has 100 nodes"), "{:?}", verdict.reasons);
    }
    let mut better = of(125, "refined");
    better.rows[0].numbers.as_mut().unwrap().p95_mm = 0.01;
    assert_eq!(against(&better).outcome, OutcomeName::Incomplete, "another question is not judged");
    let mut damaged = of(100, "refined");
    damaged.rows[0].numbers.as_mut().unwrap().p95_mm = f64::NAN;
    assert_eq!(against(&damaged).outcome, OutcomeName::Worse);
}

#[test]
fn a_baseline_whose_plan_of_the_same_name_moves_otherwise_is_reported() {
    let rows = [solved("fem", 0, [1.0, 0.1])];
    let of = |plans: Value| {
        let mut report = report(&rows, usual());
        let scene = json!({
            "name": "slab", "nodes": 100, "cells": 80, "skin_nodes": 25, "truth": "refined", "truth_s": 0.1, "plans": plans,
        });
        report.scenes = vec![serde_json::from_value(scene).unwrap()];
        report
    };
    let against = |before: Value| {
        let mut now = of(json!({"plan 1": "a", "plan 2": "b"}));
        judge(&mut now, &Baseline::Report(&of(before)));
        now.verdict
    };
    assert_eq!(against(json!({"plan 1": "a"})).outcome, OutcomeName::Pass);
    assert_eq!(against(json!({})).outcome, OutcomeName::Pass, "an earlier version tells none");
    let verdict = against(json!({"plan 1": "a", "plan 2": "c"}));
    assert_eq!(verdict.outcome, OutcomeName::Incomplete);
    assert!(verdict.reasons[0].starts_with("plan 2 of the scene"), "{:?}", verdict.reasons);
}

/// Elements of a JUnit file with their attributes and the number of children that mark a case as not passed.
fn suites(text: &str) -> Vec<(String, Vec<(String, String)>)> {
    use quick_xml::events::Event;
    let mut reader = quick_xml::Reader::from_str(text);
    let mut elements = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) | Event::Empty(start) => {
                let attributes = start.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    (attribute.key.as_ref().to_owned(), attribute.value.to_string())
                });
                elements.push((start.name().as_ref().to_owned(), attributes.collect()));
            }
            Event::Eof => return elements,
            _ => {}
        }
    }
}

#[test]
fn test_results_have_the_shape_that_ci_systems_read_and_are_red_exactly_when_the_outcome_is() {
    let mixed = [
        solved("fem & <co>", 0, [1.0, 0.1]),
        solved("slow", 0, [9.0, 0.1]),
        failed("msm", "failed", "solver-diverged"),
        failed("known", "failed", "solver-diverged"),
        failed("late", "not-run", "not-run"),
    ];
    let rules =
        json!({"tolerances": {}, "expected_failures": ["known"], "thresholds": {"wall_s": 5.0}});
    let cases: [(&[Value], Value, [usize; 4]); 3] = [
        (&mixed, rules, [6, 2, 2, 1]),
        (&mixed[..1], usual(), [2, 0, 0, 0]),
        (&[], usual(), [1, 0, 1, 0]),
    ];
    for (rows, rules, counts) in cases {
        let report = judged(rows, rules, &Baseline::NotAsked);
        let text = junit(&report);
        let elements = suites(&text);
        let count = |name: &str| elements.iter().filter(|(element, _)| element == name).count();
        assert_eq!(["testcase", "failure", "error", "skipped"].map(count), counts, "{text}");
        assert_eq!(elements[0].0, "testsuites");
        for (element, attributes) in &elements {
            let has =
                |name: &str| attributes.iter().any(|(key, value)| key == name && !value.is_empty());
            let needed: &[&str] = match element.as_str() {
                "testsuites" | "testsuite" => {
                    &["name", "tests", "failures", "errors", "skipped", "time"]
                }
                "testcase" => &["name", "classname", "time"],
                "failure" | "error" => &["type", "message"],
                "skipped" => &["message"],
                "system-out" => &[],
                other => panic!("{other}"),
            };
            assert!(needed.iter().all(|name| has(name)), "{element} {attributes:?}");
        }
        let told = |name: &str| {
            elements[0].1.iter().find(|(key, _)| key == name).unwrap().1.parse::<usize>()
        };
        assert_eq!(
            ["tests", "failures", "errors", "skipped"].map(|name| told(name).unwrap()),
            counts
        );
        let is_red = counts[1] + counts[2] > 0;
        assert_eq!(is_red, report.verdict.outcome != OutcomeName::Pass);
    }
}

#[test]
fn the_table_has_every_row_and_no_cell_is_a_formula() {
    let mut odd = solved("=cmd|' /C calc'", 0, [1.0, 0.1]);
    odd["plan"] = json!("a, \"b\"\nc");
    let report = judged(&[odd, failed("msm", "failed", "x")], usual(), &Baseline::NotAsked);
    let text = csv(&report);
    assert!(text.starts_with(&(COLUMNS.join(",") + "\r\n")));
    assert!(text.contains("slab,\"a, \"\"b\"\"\nc\",fem_linear,'=cmd|' /C calc',tet4,case,0,100,1,,0.05,0.1,0.2,solved,"));
    assert!(text.ends_with("\r\n") && text.contains(",failed,\"x: it <did> & \"\"more\"\"\","));
    assert!(text.contains("slab,4 mm,msm,msm,,case,0,,,,,,,failed,"));
}

/// What a reader of an SVG sees.
fn visible(svg: &str) -> Vec<&str> {
    let parts = svg.split("<text").skip(1);
    parts.filter_map(|part| part.split('>').nth(1)?.split('<').next()).collect()
}

#[test]
fn charts_speak_in_words() {
    let labels = ["fem_linear stabilised", "mtm damped_jacobi", "my_own", "thickness_warp"];
    let mut rows: Vec<Value> =
        (1..).zip(labels).map(|(n, label)| solved(label, 0, [f64::from(n), 0.1])).collect();
    for row in &mut rows {
        row["scene"] = json!("half_head");
        row["plan"] = json!("my_plan");
        row["effectivity"] = json!(0.8);
        row["warnings"] = json!(["linear-truth"]);
    }
    let mut broken = failed("fem_nonlinear plain", "failed", "no-equilibrium");
    broken["scene"] = json!("half_head");
    broken["error"]["detail"] = json!("`fem_nonlinear` found none");
    rows.push(broken);
    let mut report = report(&rows, usual());
    report.engine.target = "x86_64-unknown-linux-gnu".to_owned();
    let scene = json!([{
        "name": "half_head", "nodes": 1, "cells": 1, "skin_nodes": 1, "truth_s": 0.0, "truth": "mean_dilatation",
    }]);
    report.scenes = serde_json::from_value(scene).unwrap();
    let skipped = json!([{
        "scene": "half_head", "method": "mtm_ti", "label": "mtm_ti", "rows": 1, "reason": "`mtm_ti` is not",
    }]);
    report.skipped = serde_json::from_value(skipped).unwrap();
    let charts = [chart(&report, None), chart(&report, Some("half_head"))];
    for svg in charts.into_iter().chain(estimates_chart(&report)) {
        let words = visible(&svg);
        assert!(words.len() > 15, "{words:?}");
        assert!(words.iter().all(|words| !words.contains('_')), "{words:?}");
        assert!(words.contains(&"mass-tensor, damped Jacobi"), "{words:?}");
    }
    let words = chart(&report, None);
    for wanted in ["half head", "nonlinear FEM, plain", "no-equilibrium", "with a linear truth"] {
        assert!(words.contains(wanted), "{wanted}");
    }
}

#[test]
fn rows_of_earlier_programs_have_no_estimates_and_no_chart_of_them() {
    let report = report(&[solved("fem", 0, [1.0, 0.1])], usual());
    assert!(estimates_chart(&report).is_none());
    let line = csv(&report).lines().nth(1).unwrap().to_owned();
    assert!(line.ends_with(",,,,"), "{line}");
}

#[test]
fn an_outcome_names_its_failing_rows_with_what_they_exceed() {
    let before = report(&[solved("fem", 0, [1.0, 0.1])], usual());
    let mut row = solved("fem", 0, [1.0, 0.3]);
    row["iterations"] = json!(50);
    let rules = json!({"tolerances": {}, "expected_failures": [], "thresholds": {"mean_mm": 0.1, "p95_mm": 0.5}});
    let rows = [row, solved("quiet", 0, [1.0, 0.1]), failed("msm", "failed", "solver-diverged")];
    let judged = judged(&rows, rules, &Baseline::Report(&before));
    let failing = judged.verdict.failing.iter();
    let found: Vec<_> = failing
        .map(|row| (row.label.as_str(), row.measure.as_deref(), row.value, row.limit))
        .collect();
    let expected = [
        ("fem", Some("mean_mm"), Some(0.15), Some(0.1)),
        ("fem", Some("p95_mm"), Some(0.3), Some(0.1 * 1.05)),
        ("fem", Some("iterations"), Some(50.0), Some(10.0)),
        ("msm", None, None, None),
    ];
    assert_eq!(found, expected);
    let first = judged.verdict.failing[0].sentence();
    assert_eq!(
        first,
        "slab, 4 mm, fem, case, level 0: mean error 0.1500 mm is above the threshold 0.1 mm"
    );
    let told = serde_json::to_value(judged.summary()).unwrap();
    assert_eq!(told["verdict"]["failing"][1]["limit"], json!(0.1 * 1.05));
    let passed = self::judged(&rows[1..2], usual(), &Baseline::NotAsked);
    assert!(passed.verdict.failing.is_empty());
}

/// The colours within the legend entry of a variant.
fn colours<'a>(svg: &'a str, label: &str) -> Vec<&'a str> {
    let entry = format!("<g class=\"legend\" data-label=\"{label}\"");
    let group = svg.split(&entry).nth(1).unwrap_or_else(|| panic!("no {label}"));
    let group = group.split("</g>").next().unwrap();
    group.split("stroke=\"").skip(1).map(|part| part.split('"').next().unwrap()).collect()
}

#[test]
fn a_way_of_modelling_has_one_symbol_in_every_chart_of_a_report() {
    let mut rows = [solved("msm newton", 0, [1.0, 0.1]), solved("fem_linear plain", 0, [2.0, 0.1])];
    rows[1]["effectivity"] = json!(0.8);
    let mut other = solved("fem_linear plain", 1, [2.0, 0.1]);
    other["scene"] = json!("sphere");
    let report = report(&[rows[0].clone(), rows[1].clone(), other], usual());
    let all = chart(&report, None);
    let of_all = colours(&all, "fem_linear plain");
    assert_ne!(of_all, colours(&all, "msm newton"));
    for svg in [chart(&report, Some("sphere")), estimates_chart(&report).unwrap()] {
        assert_eq!(colours(&svg, "fem_linear plain"), of_all);
        assert!(
            !svg.contains("data-label=\"msm newton\""),
            "what a chart does not show is not in its legend"
        );
    }
    assert!(all.contains("<g class=\"mark\" data-label=\"fem_linear plain\" data-method=\"fem_linear\" data-level=\"1\">"));
}

#[test]
fn rows_that_cannot_be_compared_are_reported_in_the_legend_and_below_the_chart() {
    let mut rows = [solved("fem_linear plain", 0, [1.0, 0.1]), solved("pressing", 0, [2.0, 0.1])];
    rows[1]["warnings"] = json!(["truth-without-contact", "within-truth-error"]);
    let svg = chart(&report(&rows, usual()), None);
    let words = visible(&svg).join(" ");
    assert!(words.contains("pressing (not comparable)"), "{words}");
    for told in ["1 of 2 rows (truth-without-contact)", "1 of 2 rows (within-truth-error)"] {
        assert!(words.contains(told), "{words}");
    }
}
