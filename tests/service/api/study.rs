//! Studies over HTTP: methods side by side, the report in every form, the gate, what is refused.

use std::collections::BTreeMap;

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

/// The slab with one plan and two elements, against stabilised elements on halved edges: some hundred unknowns. Times
/// decide nothing, since other tests run beside this one.
fn slab() -> Value {
    json!({
        "kind": "study", "scenes": ["slab"], "plans": ["patch 2 mm"], "methods": ["fem_linear"],
        "elements": ["plain", "stabilised"],
        "materials": [{"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}}],
        "truth": {"refine": 1, "element": "stabilised"}, "repeats": 1,
        "tolerances": {"wall_ratio": 1000},
    })
}

/// One variant called `fem`.
fn one(element: &str) -> Value {
    let mut spec = slab();
    spec["methods"] = json!([{"method": "fem_linear", "element": element, "label": "fem"}]);
    spec.as_object_mut().unwrap().remove("elements");
    // One of them takes a factorisation, the other iterations.
    spec["tolerances"] = json!({"iterations_ratio": 100});
    spec
}

/// The finished job.
async fn done(server: &Server, spec: &Value) -> Value {
    let answer = server.job(spec).await;
    let job = answer.json();
    assert!(answer.status.is_success(), "{job}");
    let job = server.ended(job["id"].as_str().unwrap()).await;
    assert_eq!(job["status"], "successful", "{job}");
    job
}

async fn report(server: &Server, job: &Value, query: &str) -> Answer {
    let id = job["id"].as_str().unwrap();
    ask(server.get(&format!("/v1/jobs/{id}/report{query}"))).await
}

/// The rows of a table without quoted cells, by column.
fn table(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), head.len(), "{line}");
        head.iter().zip(cells).map(|(name, cell)| ((*name).to_owned(), cell.to_owned())).collect()
    };
    lines.map(row).collect()
}

#[tokio::test]
#[expect(clippy::too_many_lines, reason = "one report, held against each of its four forms")]
async fn a_study_is_reported_as_document_table_test_results_and_chart() {
    let server = Server::start();
    let job = done(&server, &slab()).await;
    let summary = &job["results"]["study"];
    assert_eq!(summary["verdict"]["outcome"], "pass", "{summary}");
    let files: Vec<&str> = job["results"]["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        files,
        ["report.json", "report.csv", "report.junit.xml", "chart.svg", "estimates.svg"]
    );
    assert!(job["links"].as_array().unwrap().iter().any(|link| link["rel"] == "describedby"));

    let answer = report(&server, &job, "").await;
    assert_eq!(answer.header("facies-outcome"), "pass");
    let document = answer.expect(StatusCode::OK);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!((&document["job"], &document["spec_hash"]), (&job["id"], &job["spec_hash"]));
    let p95 = |row: &Value| row["p95_mm"].as_f64().unwrap();
    assert_eq!(
        (&rows[0]["label"], &rows[0]["element"]),
        (&json!("fem_linear plain"), &json!("tet4 plain"))
    );
    // Plain tetrahedra lock: that is what the chart is to show.
    assert!(p95(&rows[0]) > 2.0 * p95(&rows[1]) && p95(&rows[1]) > 0.0, "{rows:?}");
    assert!(rows.iter().all(|row| row["wall_s"].as_f64().unwrap() > 0.0));
    assert!(rows[1]["on_front"].as_bool().unwrap());
    assert_eq!(document["scenes"][0]["name"], "slab");
    let pair = &document["comparisons"][0];
    assert_eq!((&pair["scenes"], &pair["test"]["smallest_p"]), (&json!(1), &json!(1.0)));
    assert!(pair["sentence"].as_str().unwrap().contains("too few to tell"), "{pair}");

    let csv = report(&server, &job, "?format=csv").await;
    assert_eq!(csv.header("content-type"), "text/csv; charset=utf-8");
    let table = table(std::str::from_utf8(&csv.bytes).unwrap());
    assert_eq!(table.len(), rows.len());
    for (line, row) in table.iter().zip(rows) {
        for name in ["scene", "plan", "method", "label", "element", "material", "status", "verdict"]
        {
            assert_eq!(line[name], row[name].as_str().unwrap(), "{name}");
        }
        for name in ["level", "unknowns", "wall_s", "peak_mb", "mean_mm", "p95_mm", "max_mm"] {
            let told = row[name].as_f64();
            assert_eq!(line[name].parse::<f64>().ok(), told, "{name}");
        }
    }

    let junit = report(&server, &job, "?format=junit").await;
    let text = String::from_utf8(junit.bytes.clone()).unwrap();
    assert!(
        text.contains("<testsuites name=\"facies study\" tests=\"3\" failures=\"0\" errors=\"0\""),
        "{text}"
    );
    let chart = report(&server, &job, "?format=svg").await;
    let text = String::from_utf8(chart.bytes.clone()).unwrap();
    assert_eq!(text.matches("<g class=\"mark\" ").count(), 2);

    // The header Accept is the other way to ask.
    let path = format!("/v1/jobs/{}/report", job["id"].as_str().unwrap());
    for (accept, same) in
        [("text/csv", &csv), ("application/xml", &junit), ("image/svg+xml", &chart)]
    {
        let answer = ask(server.get(&path).header("accept", accept)).await;
        assert_eq!((answer.status, &answer.bytes), (StatusCode::OK, &same.bytes), "{accept}");
        assert_eq!(answer.header("content-type").split(';').next(), Some(accept));
        let known = server
            .get(&path)
            .header("accept", accept)
            .header("if-none-match", answer.header("etag"));
        assert_eq!(ask(known).await.status, StatusCode::NOT_MODIFIED);
    }
    ask(server.get(&path).header("accept", "image/png")).await.problem(406, "not-acceptable");
    ask(server.get(&format!("{path}?format=html"))).await.problem(400, "invalid-parameter");
    let again = server.job(&slab()).await.expect(StatusCode::OK);
    assert_eq!((&again["deduplicated"], &again["id"]), (&json!(true), &job["id"]));
}

#[tokio::test]
async fn a_study_that_is_worse_than_its_baseline_says_so_in_every_form() {
    let server = Server::start();
    let better = done(&server, &one("stabilised")).await;
    let worse = done(&server, &one("plain")).await;
    assert_eq!(worse["results"]["study"]["verdict"]["outcome"], "pass", "nothing to compare with");
    let against = |job: &Value| format!("?baseline={}", job["id"].as_str().unwrap());

    let answer = report(&server, &worse, &against(&better)).await;
    assert_eq!(answer.header("facies-outcome"), "worse");
    let judged = answer.expect(StatusCode::OK);
    assert_eq!(judged["verdict"]["baseline"], better["id"]);
    let row = &judged["rows"][0];
    assert_eq!(row["verdict"], "worse");
    let reason = row["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("p95 error") && reason.ends_with("1.05 are allowed"), "{reason}");
    let junit = report(&server, &worse, &(against(&better) + "&format=junit")).await;
    let text = String::from_utf8(junit.bytes).unwrap();
    assert!(
        text.contains("tests=\"2\" failures=\"2\" errors=\"0\"") && text.contains("type=\"worse\""),
        "{text}"
    );
    let csv = report(&server, &worse, &(against(&better) + "&format=csv")).await;
    assert!(String::from_utf8(csv.bytes).unwrap().contains(",worse,\"p95 error"));
    let other_way = report(&server, &better, &against(&worse)).await;
    assert_eq!(other_way.header("facies-outcome"), "pass");

    // The same as part of the spec.
    let mut spec = one("plain");
    spec["baseline"] = better["id"].clone();
    let job = done(&server, &spec).await;
    assert_ne!(job["id"], worse["id"], "what decides the outcome decides the job");
    let verdict = &job["results"]["study"]["verdict"];
    assert_eq!((&verdict["outcome"], &verdict["worse"]), (&json!("worse"), &json!(1)));

    // A baseline of other rows, one that is no study, and one that is nothing.
    let mut other = one("stabilised");
    other["plans"] = json!(["patch 1 mm"]);
    let other = done(&server, &other).await;
    let nothing = json!({"id": uuid::Uuid::now_v7().to_string()});
    for missing in [&other, &nothing] {
        let answer = report(&server, &worse, &against(missing)).await;
        assert_eq!(answer.header("facies-outcome"), "no-baseline");
        let junit = report(&server, &worse, &(against(missing) + "&format=junit")).await;
        assert!(String::from_utf8(junit.bytes).unwrap().contains("<error type=\"no-baseline\""));
    }
    report(&server, &worse, "?baseline=yesterday").await.problem(400, "invalid-parameter");
}

#[tokio::test]
async fn thresholds_and_time_decide_the_outcome() {
    let server = Server::start();
    let mut spec = slab();
    spec["thresholds"] = json!({"p95_mm": 1e-6, "labels": ["fem_linear plain"]});
    let job = done(&server, &spec).await;
    let verdict = &job["results"]["study"]["verdict"];
    assert_eq!((&verdict["outcome"], &verdict["worse"]), (&json!("worse"), &json!(1)));

    spec["thresholds"] = json!({"p95_mm": 50.0});
    spec["budget"] = json!({"wall_s": 0.001});
    let job = done(&server, &spec).await;
    let verdict = &job["results"]["study"]["verdict"];
    assert_eq!(verdict["outcome"], "incomplete", "{verdict}");
    let rows = report(&server, &job, "").await.expect(StatusCode::OK)["rows"].clone();
    // The first row may have begun within the millisecond, the second never has.
    let last = &rows[1];
    assert_eq!((&last["status"], &last["error"]["type"]), (&json!("not-run"), &json!("not-run")));

    // Rows that were not run are not kept for another threshold.
    spec["thresholds"] = json!({"p95_mm": 49.0});
    let again = done(&server, &spec).await;
    let found = report(&server, &again, "").await.expect(StatusCode::OK);
    assert_eq!(found.get("rows_of"), None);
}

#[tokio::test]
async fn other_rules_judge_the_rows_of_an_earlier_study_again() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [2.0, 0.0, 0.0]}]});
    let study = |case: &str, bound: f64| {
        json!({
            "kind": "study", "scenes": [{"case": case, "name": "block"}], "plans": [plan], "repeats": 1,
            "methods": ["fem_linear"], "elements": ["auto", "plain"],
            "truth": {"refine": 1, "element": "mean_dilatation"}, "thresholds": {"p95_mm": bound},
        })
    };
    let first = done(&server, &study(&case, 50.0)).await;
    let before = report(&server, &first, "").await.expect(StatusCode::OK);
    assert_eq!((&before["verdict"]["outcome"], before.get("rows_of")), (&json!("pass"), None));
    // The cost of the truth was told: two meshes, eight cells of one.
    let truth = &first["truths"][0];
    assert_eq!((&truth["scene"], &truth["meshes"]), (&json!("block"), &json!(2)));
    assert_eq!(truth["cells"], 8 * before["scenes"][0]["cells"].as_u64().unwrap());
    assert!(truth["time_s"]["high"].as_f64() > truth["time_s"]["low"].as_f64(), "{truth}");

    let second = done(&server, &study(&case, 1e-6)).await;
    let after = report(&server, &second, "").await.expect(StatusCode::OK);
    assert_eq!(after["verdict"]["outcome"], "worse", "a new threshold, a new verdict");
    assert_eq!(after["rows_of"], json!({"job": first["id"], "created": before["created"]}));
    assert_eq!((&after["job"], &after["rows_key"]), (&second["id"], &before["rows_key"]));
    assert_eq!(second.get("truths"), None, "no truth was solved");
    // Times too are those that were measured: nothing was solved again.
    for (before, after) in
        before["rows"].as_array().unwrap().iter().zip(after["rows"].as_array().unwrap())
    {
        assert_eq!((&before["wall_s"], &before["p95_mm"]), (&after["wall_s"], &after["p95_mm"]));
    }

    // What is solved otherwise, and what is of another patient, is solved anew.
    let mut finer = study(&case, 1e-6);
    finer["repeats"] = json!(2);
    let other = server.case(&SMALL).await;
    for spec in [finer, study(&other, 2e-6)] {
        let job = done(&server, &spec).await;
        let found = report(&server, &job, "").await.expect(StatusCode::OK);
        assert_eq!(found.get("rows_of"), None);
    }

    // A case takes the study that took the rows with it.
    let erase = server.delete(&format!("/v1/cases/{case}")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    for job in [first, second] {
        let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
        ask(server.get(&path)).await.problem(410, "gone");
    }
}

#[tokio::test]
async fn cases_are_studied_against_the_skin_of_a_job_and_go_with_their_studies() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let truth = server.job(&spec(&case, 2.0)).await.expect(StatusCode::OK);
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [2.0, 0.0, 0.0]}]});
    let study = json!({
        "kind": "study", "scenes": [{"case": case, "name": "block"}], "plans": [plan],
        "methods": ["fem_linear"], "elements": ["auto", "plain"], "repeats": 1,
        "truth": {"job": truth["id"]},
    });
    let job = done(&server, &study).await;
    assert_eq!(job["case"], case);
    let rows = report(&server, &job, "").await.expect(StatusCode::OK)["rows"].clone();
    assert_eq!((&rows[0]["scene"], &rows[0]["plan"]), (&json!("block"), &json!("plan 1")));
    // Positions of the skin are stored in full: the same method finds what it found.
    assert!(rows[0]["max_mm"].as_f64().unwrap() < 1e-6, "{rows}");
    assert!(rows[1]["p95_mm"].as_f64().unwrap() > 1e-3, "{rows}");
    // A row of finite strain is told what is in its error; a linear one has nothing of that.
    let mut finite = study.clone();
    finite["methods"] = json!(["fem_linear", "fem_nonlinear"]);
    finite["elements"] = json!(["auto"]);
    let of_job = |method: &str| {
        let mut predict = spec(&case, 2.0);
        predict["method"] = json!(method);
        predict
    };
    for (method, is_told) in [("fem_linear", true), ("fem_nonlinear", false)] {
        let truth = server.job(&of_job(method)).await.expect(StatusCode::OK);
        finite["truth"] = json!({"job": truth["id"]});
        let job = done(&server, &finite).await;
        let rows = report(&server, &job, "").await.expect(StatusCode::OK)["rows"].clone();
        let told = |row: &Value| row["warnings"].to_string().contains("linear-truth");
        assert_eq!((told(&rows[0]), told(&rows[1])), (false, is_told), "{method}: {rows}");
    }

    let second = server.case(&SMALL).await;
    let mut both = study.clone();
    both["scenes"] = json!([{"case": case, "name": "a"}, {"case": second, "name": "b"}]);
    both["truth"] = json!({"refine": 1, "element": "mean_dilatation"});
    let job = done(&server, &both).await;
    let document = report(&server, &job, "").await.expect(StatusCode::OK);
    assert_eq!(document["comparisons"][0]["scenes"], 2);
    let files = job["results"]["files"].to_string();
    assert!(files.contains("chart-1-a.svg") && files.contains("chart-2-b.svg"), "{files}");

    let path = format!("/v1/cases/{second}");
    let erased = ask(server.delete(&path).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    let gone = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    ask(server.get(&gone)).await.problem(410, "gone");
}

#[tokio::test]
async fn a_study_goes_with_the_cases_of_what_it_is_held_against() {
    let server = Server::start();
    let (truth, scene) = (server.case(&SMALL).await, server.case(&SMALL).await);
    let predicted = server.job(&spec(&truth, 2.0)).await.expect(StatusCode::OK);
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [2.0, 0.0, 0.0]}]});
    let mut study = json!({
        "kind": "study", "scenes": [{"case": scene, "name": "block"}], "plans": [plan],
        "methods": ["fem_linear"], "elements": ["auto"], "repeats": 1, "truth": {"job": predicted["id"]},
    });
    let held_against_truth = done(&server, &study).await;
    study["baseline"] = held_against_truth["id"].clone();
    study["truth"] = json!({"refine": 1, "element": "mean_dilatation"});
    let held_against_baseline = done(&server, &study).await;
    let erase = server.delete(&format!("/v1/cases/{truth}")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    for job in [held_against_truth, held_against_baseline] {
        let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
        ask(server.get(&path)).await.problem(410, "gone");
    }
}

#[tokio::test]
async fn a_study_counts_its_rows_and_stops_when_it_is_dismissed() {
    let server = Server::start_with(&["--workers", "1"]);
    let mut long = slab();
    long["plans"] = json!([]);
    long["levels"] = json!([0, 1, 2, 3]);
    long["repeats"] = json!(20);
    let job = ask(server.post("/v1/jobs").json(&long)).await.expect(StatusCode::CREATED);
    let id = job["id"].as_str().unwrap();
    let path = format!("/v1/jobs/{id}/report");
    ask(server.get(&path)).await.problem(404, "result-not-ready");
    assert_eq!(server.started(id).await["status"], "running");
    let dismissed = ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    assert_eq!(dismissed["status"], "dismissed");
    ask(server.get(&path)).await.problem(422, "job-failed");
    // The one worker is free again.
    let case = server.case(&SMALL).await;
    let next = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let none = format!("/v1/jobs/{}/report", next["id"].as_str().unwrap());
    ask(server.get(&none)).await.problem(404, "no-such-output");
}

#[tokio::test]
async fn all_mistakes_of_a_study_are_told_together() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let nobody = uuid::Uuid::now_v7();
    let wrong = |name: &str| json!({"segments": [{"name": name, "translation_mm": [1, 0, 0]}]});
    let mut study = json!({
        "kind": "study", "scenes": [{"case": case, "plans": [wrong("nose"), wrong("ear")]}],
        "methods": ["fem_linear", "guess"], "repeats": 1, "truth": {"refine": 1},
    });
    let places = async |study: &Value| -> Vec<String> {
        let problem = server.job(study).await.problem(422, "validation-failed");
        let errors = problem["errors"].as_array().unwrap().clone();
        errors.iter().map(|own| own["pointer"].as_str().unwrap().to_owned()).collect()
    };
    let told = places(&study).await;
    let plan = |number: usize| format!("/scenes/0/plans/{number}/segments/0/name");
    assert_eq!(told, ["/methods/1", &plan(0), &plan(1)]);
    study["scenes"] = json!([{"case": nobody}, {"case": nobody, "name": "again"}]);
    study["repeats"] = json!(0);
    let told = places(&study).await;
    for place in ["/scenes/0/case", "/scenes/1/case", "/repeats", "/methods/1"] {
        assert!(told.iter().any(|own| own == place), "{place}: {told:?}");
    }
}

/// Name, what is put into a spec, the code of the problem, the pointer of its first mistake.
type Row = (&'static str, Value, &'static str, &'static str);

fn bad_scenes() -> Vec<Row> {
    let invalid = "validation-failed";
    let nobody = uuid::Uuid::now_v7();
    vec![
        ("no scene", json!({"scenes": []}), invalid, "/scenes"),
        ("unknown scene", json!({"scenes": ["nose"]}), invalid, "/scenes/0"),
        ("twice", json!({"scenes": ["slab", "slab"]}), invalid, "/scenes/1"),
        ("number", json!({"scenes": [7]}), invalid, "/scenes/0"),
        ("unknown case", json!({"scenes": [{"case": nobody}]}), invalid, "/scenes/0/case"),
        ("misspelt", json!({"scenes": [{"case": nobody, "nom": "a"}]}), invalid, "/scenes/0/nom"),
        ("unknown plan", json!({"plans": ["patch 3 mm"]}), invalid, "/plans"),
        ("one unknown plan", json!({"plans": ["patch 2 mm", "x"]}), invalid, "/plans/1"),
        ("plan for no case", json!({"plans": [{"segments": []}]}), invalid, "/plans/0"),
        ("misspelt plan", json!({"plans": [{"segment": []}]}), invalid, "/plans/0/segment"),
        ("truth twice", json!({"truth": {"refine": 1, "closed_form": true}}), invalid, "/truth"),
        ("no truth", json!({"truth": {}}), invalid, "/truth"),
        ("too fine", json!({"truth": {"refine": 5}}), invalid, "/truth/refine"),
        ("no formula", json!({"truth": {"closed_form": true}}), invalid, "/truth/closed_form"),
        ("no such truth", json!({"truth": {"job": nobody}}), invalid, "/truth/job"),
        ("no level", json!({"levels": []}), invalid, "/levels"),
        ("level twice", json!({"levels": [1, 1]}), invalid, "/levels/1"),
        ("level 9", json!({"levels": [0, 9]}), invalid, "/levels/1"),
        ("both", json!({"sweep": {"*": {"poisson_ratio": [0.3]}}}), invalid, ""),
        (
            "nu 0.5",
            json!({"materials": [{"*": {"young_modulus_kpa": 1, "poisson_ratio": 0.5}}]}),
            invalid,
            "/materials/0/*/poisson_ratio",
        ),
        (
            "half",
            json!({"materials": [{"*": {"young_modulus_kpa": 1}}]}),
            invalid,
            "/materials/0/*/poisson_ratio",
        ),
        (
            "swept away",
            json!({"materials": [], "sweep": {"*": {"poisson_ratio": [0.6]}}}),
            invalid,
            "/sweep/*",
        ),
        (
            "no region",
            json!({"materials": [], "sweep": {"nose": {"poisson_ratio": [0.3]}}}),
            invalid,
            "/sweep/nose",
        ),
    ]
}

fn bad_methods() -> Vec<Row> {
    let invalid = "validation-failed";
    let method = |entry: Value| json!({"methods": ["fem_linear", entry], "elements": []});
    vec![
        ("no method", json!({"methods": []}), invalid, "/methods"),
        ("guess", method(json!("guess")), invalid, "/methods/1"),
        ("not built", method(json!("fem_ogden")), "method-not-available", "/methods/1"),
        (
            "not built here",
            method(json!({"method": "fem_ogden"})),
            "method-not-available",
            "/methods/1/method",
        ),
        (
            "misspelt",
            method(json!({"method": "fem_linear", "elements": "plain"})),
            invalid,
            "/methods/1/elements",
        ),
        (
            "a plan in it",
            method(json!({"method": "fem_linear", "plan": {}})),
            invalid,
            "/methods/1/plan",
        ),
        (
            "corrected",
            method(json!({"method": "fem_linear", "corrected": true})),
            invalid,
            "/methods/1/corrected",
        ),
        (
            "an accepted error",
            method(json!({"label": "a", "accept_mm": -1})),
            invalid,
            "/methods/1/accept_mm",
        ),
        (
            "residual 1",
            method(json!({"method": "fem_linear", "tolerance": {"relative_residual": 1}})),
            invalid,
            "/methods/1/tolerance/relative_residual",
        ),
        (
            "label 7",
            method(json!({"method": "fem_linear", "label": 7})),
            invalid,
            "/methods/1/label",
        ),
        ("two of a name", json!({"methods": ["fem_linear", "fem_linear"]}), invalid, "/methods"),
        ("no element", json!({"elements": ["cubic"]}), invalid, "/elements/0"),
    ]
}

fn bad_rules() -> Vec<Row> {
    let invalid = "validation-failed";
    let nobody = uuid::Uuid::now_v7();
    vec![
        ("repeats 0", json!({"repeats": 0}), invalid, "/repeats"),
        ("no bound", json!({"thresholds": {}}), invalid, "/thresholds"),
        ("bound 0", json!({"thresholds": {"p95_mm": 0}}), invalid, "/thresholds/p95_mm"),
        (
            "whose bound",
            json!({"thresholds": {"p95_mm": 1, "labels": ["msm"]}}),
            invalid,
            "/thresholds/labels/0",
        ),
        ("who fails", json!({"expected_failures": ["msm"]}), invalid, "/expected_failures/0"),
        ("ratio 0.5", json!({"tolerances": {"p95_ratio": 0.5}}), invalid, "/tolerances/p95_ratio"),
        ("no baseline", json!({"baseline": nobody}), invalid, "/baseline"),
        ("ratio 0", json!({"tolerances": {"wall_ratio": 0}}), invalid, "/tolerances/wall_ratio"),
        (
            "iterations 0",
            json!({"tolerances": {"iterations_ratio": 0}}),
            invalid,
            "/tolerances/iterations_ratio",
        ),
        ("time 0", json!({"budget": {"wall_s": 0}}), invalid, "/budget/wall_s"),
        ("memory 0", json!({"budget": {"memory_mb": 0}}), invalid, "/budget/memory_mb"),
        ("unknown field", json!({"scene": "slab"}), invalid, "/scene"),
    ]
}

#[tokio::test]
async fn every_bad_study_is_refused_with_its_place() {
    let server = Server::start_with(&["--workers", "0"]);
    let rows = [bad_scenes(), bad_methods(), bad_rules()].concat();
    for (name, change, code, pointer) in rows {
        let mut spec = slab();
        spec.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        let answer = ask(server.post("/v1/jobs").json(&spec)).await;
        let problem = answer.problem_of(name, 422, code);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{name}: {problem}");
    }
    let values: Vec<f64> = (0..60).map(|k| 10.0 + f64::from(k)).collect();
    let mut spec = slab();
    let members = spec.as_object_mut().unwrap();
    members.remove("materials");
    members.insert("sweep".into(), json!({"*": {"young_modulus_kpa": values}}));
    members.insert("plans".into(), json!([]));
    members.insert("levels".into(), json!([0, 1, 2, 3]));
    let problem = ask(server.post("/v1/jobs").json(&spec)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["code"], "too-many", "{problem}");
    let listed = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"], json!([]), "nothing was accepted");
}

#[tokio::test]
async fn a_plan_that_does_not_fit_a_case_is_refused_at_its_place_in_the_study() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let plan = |name: &str| json!({"segments": [{"name": name, "translation_mm": [1, 0, 0]}]});
    let spec = |change: Value| {
        let mut spec =
            json!({"kind": "study", "scenes": [{"case": case}], "plans": [plan("bone")]});
        spec.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        spec
    };
    let material = json!({"nose": {"young_modulus_kpa": 1}});
    for (change, pointer) in [
        (json!({"plans": [plan("bone"), plan("nose")]}), "/plans/1/segments/0/name"),
        (json!({"plans": []}), "/plans"),
        (json!({"materials": [{}, material]}), "/materials/1/nose"),
        (json!({"truth": {"closed_form": true}}), "/truth/closed_form"),
        // The block is made of hexahedra: told before its rows are solved, and not after them.
        (json!({"truth": {"refine": 1, "element": "quadratic"}}), "/truth/element"),
    ] {
        let answer = ask(server.post("/v1/jobs").json(&spec(change))).await;
        let problem = answer.json();
        assert_eq!(
            (answer.status.as_u16(), &problem["errors"][0]["pointer"]),
            (422, &json!(pointer)),
            "{problem}"
        );
    }
}

/// Plain Jacobi diverges: that is what the program's own variant is there to show, and no excuse for a client's.
#[tokio::test]
async fn a_variant_of_a_client_that_is_called_like_one_that_may_fail_fails_its_gate() {
    let server = Server::start();
    let mut spec = slab();
    spec.as_object_mut().unwrap().remove("elements");
    let ended = async |methods: Value| {
        let mut spec = spec.clone();
        spec["methods"] = methods;
        let job = done(&server, &spec).await;
        let report = report(&server, &job, "").await.json();
        let rows = report["rows"].as_array().unwrap().clone();
        let jacobi = rows.into_iter().find(|row| row["label"] == "mtm jacobi").unwrap();
        assert_eq!(jacobi["error"]["type"], "solver-diverged", "{jacobi}");
        let outcome = report["verdict"]["outcome"].clone();
        (outcome, jacobi["verdict"].clone(), report["rules"]["expected_failures"].clone())
    };
    let of_a_client =
        json!({"method": "mtm", "mtm": {"iterations": "jacobi"}, "label": "mtm jacobi"});
    let clients = ended(json!(["fem_linear", of_a_client])).await;
    assert_eq!(clients, (json!("worse"), json!("failed"), json!([])));
    let own = ended(json!(["mtm"])).await;
    assert_eq!(own, (json!("pass"), json!("known-failure"), json!(["mtm jacobi"])));
}

#[tokio::test]
async fn a_report_and_a_file_are_waited_for_by_who_prefers_to() {
    let server = Server::start();
    let posted = ask(server.post("/v1/jobs").json(&slab())).await.expect(StatusCode::CREATED);
    let path = format!("/v1/jobs/{}", posted["id"].as_str().unwrap());
    let waiting = |of: &str| server.get(&format!("{path}{of}")).header("prefer", "wait=30");
    let reported = ask(waiting("/report?format=svg")).await;
    assert_eq!(reported.status, StatusCode::OK);
    assert_eq!(ask(waiting("/results/report.csv")).await.status, StatusCode::OK);
}
