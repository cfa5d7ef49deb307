//! Growth and muscles over HTTP: in predictions, in responses, in inverse plans, and refused where they are not known.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask};

/// A block on two bones with muscles under its skin.
fn block(muscles: Value) -> Value {
    let mut case = SMALL.case();
    case["skin"] = json!({"node_set": "z_max"});
    case["segments"] = json!([{"name": "left", "nodes": {"node_set": "x_min"}}]);
    case["fixed"] = json!([{"node_set": "z_min"}]);
    case["muscles"] = muscles;
    case
}

fn strap() -> Value {
    json!({"name": "strap", "lines_mm": [[[10, 30, 25], [50, 30, 25]]], "within_mm": 15})
}

async fn posted(server: &Server, case: &Value) -> String {
    let answer = ask(server.post("/v1/cases").multipart(SMALL.form(case))).await;
    answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
}

async fn case(server: &Server) -> String {
    let slab = json!({"name": "slab", "region": "tissue", "direction": [0, 1, 0]});
    posted(server, &block(json!([strap(), slab]))).await
}

fn plan() -> Value {
    json!({
        "segments": [{"name": "left", "translation_mm": [0, 2, 1]}],
        "growth": [{"region": "*", "volume_change": -0.05}],
        "activations": [{"muscle": "strap", "stress_kpa": 5.0}],
    })
}

async fn done(server: &Server, spec: &Value) -> Value {
    let job = server.job(spec).await.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    job
}

async fn apply(server: &Server, case: &str, plan: &Value) -> Answer {
    let path = format!("/v1/cases/{case}/response/apply");
    ask(server.post(&path).json(&json!({"plan": plan}))).await
}

/// The displacement of the skin of a prediction, by node.
async fn skin(server: &Server, job: &Value) -> Vec<[f64; 3]> {
    let path = format!("/v1/jobs/{}/results/skin.csv", job["id"].as_str().unwrap());
    let text = String::from_utf8(ask(server.get(&path)).await.bytes).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let axes = ["ux_mm", "uy_mm", "uz_mm"]
        .map(|name| head.iter().position(|other| *other == name).unwrap());
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        axes.map(|axis| cells[axis].parse().unwrap())
    };
    lines.map(row).collect()
}

fn largest_difference(one: &[[f64; 3]], other: &[[f64; 3]]) -> f64 {
    let values = one.as_flattened().iter().zip(other.as_flattened());
    values.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[tokio::test]
async fn growth_and_activations_are_predicted_and_applied_alike() {
    let server = Server::start();
    let case = case(&server).await;
    let spec = json!({"kind": "predict", "case": case, "plan": plan(), "outputs": ["skin.csv"],
        "method": "fem_linear", "tolerance": {"relative_residual": 1e-12}});
    let predicted = done(&server, &spec).await;
    let results = &predicted["results"];
    assert!(!results["nonlinearity_mm"].is_null(), "{results}");
    assert!(!results["numerical_error_mm"].is_null(), "{results}");
    let exact = skin(&server, &predicted).await;

    let built = done(&server, &json!({"kind": "response", "case": case, "growth": ["*"]})).await;
    let description = ask(server.get(&format!("/v1/cases/{case}/response"))).await;
    let description = description.expect(StatusCode::OK);
    assert_eq!(
        description["inner_columns"],
        json!([
            {"kind": "growth", "name": "*"},
            {"kind": "muscle", "name": "strap"},
            {"kind": "muscle", "name": "slab"},
        ])
    );
    assert_eq!((&description["columns"]["count"], &description["job"]), (&json!(15), &built["id"]));
    let answer = apply(&server, &case, &plan()).await;
    let applied = answer.expect(StatusCode::OK);
    let moved: Vec<[f64; 3]> = serde_json::from_value(applied["displacement_mm"].clone()).unwrap();
    assert!(largest_difference(&moved, &exact) < 1e-4);
    for unknown in ["nonlinearity_estimate_mm", "within_linear_range"] {
        assert_eq!(applied.get(unknown), Some(&json!(null)), "{applied}");
    }
    assert_eq!(applied["warnings"][0]["code"], "nonlinearity-unknown");

    // A pull in Pa is suspect to both.
    let mut pulled = plan();
    pulled["activations"][0]["stress_kpa"] = json!(5000.0);
    let applied = apply(&server, &case, &pulled).await.expect(StatusCode::OK);
    let body = json!({"plan": pulled, "method": "fem_linear"});
    let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&body)).await;
    for told in [&applied["warnings"], &checked.expect(StatusCode::OK)["warnings"]] {
        let suspect = told.as_array().unwrap().iter();
        let suspect: Vec<&Value> =
            suspect.filter(|warning| warning["code"] == "constant-suspect").collect();
        assert_eq!(suspect.len(), 1, "{told}");
        assert_eq!(suspect[0]["value"], 5000.0);
    }

    // Without them the skin is another, and its estimate is there.
    let alone = json!({"segments": plan()["segments"]});
    let applied = apply(&server, &case, &alone).await.expect(StatusCode::OK);
    let moved: Vec<[f64; 3]> = serde_json::from_value(applied["displacement_mm"].clone()).unwrap();
    assert!(largest_difference(&moved, &exact) > 0.05);
    assert!(applied["nonlinearity_estimate_mm"].as_f64().is_some());
}

#[tokio::test]
async fn growth_of_everything_else_is_refused_where_nothing_else_is_left() {
    let server = Server::start();
    let case = case(&server).await;
    let both = json!([{"region": "tissue", "volume_change": -0.05}, {"region": "*", "volume_change": -0.1}]);
    let plan = json!({"segments": plan()["segments"], "growth": both});
    let response = json!({"kind": "response", "case": case, "growth": ["*", "tissue"]});
    done(&server, &response).await;
    let predict = json!({"kind": "predict", "case": case, "plan": plan, "method": "fem_linear"});
    let optimise = json!({"kind": "optimise", "case": case, "growth": [both[0]],
        "targets": [{"nodes": {"node_set": "z_max"}, "displacement_mm": [0, 0.5, 0.2]}], "bounds": {},
        "tissue_bounds": {"*": {"volume_change": [-0.1, 0.1]}}});
    for (answer, place) in [
        (server.job(&predict).await, "/plan/growth/1/region"),
        (apply(&server, &case, &plan).await, "/plan/growth/1/region"),
        (server.job(&optimise).await, "/tissue_bounds/*/volume_change"),
    ] {
        let problem = answer.problem(422, "validation-failed");
        let told = &problem["errors"][0];
        assert_eq!((&told["pointer"], &told["code"]), (&json!(place), &json!("unknown-region")));
        assert!(told["detail"].as_str().unwrap().contains("no cell is left to `*`"), "{told}");
    }
    // One of them alone is both a prediction and an applied plan.
    let alone = json!({"segments": plan["segments"], "growth": [both[0]]});
    apply(&server, &case, &alone).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_check_says_that_it_does_not_foresee_the_choice_where_more_than_segments_deforms_tissue()
{
    let server = Server::start();
    let case = case(&server).await;
    let why = async |plan: Value| {
        let body = json!({"plan": plan, "method": "auto"});
        let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&body)).await;
        let checked = checked.expect(StatusCode::OK);
        (checked.get("auto").is_some(), checked["why"].as_str().unwrap().to_owned())
    };
    let (is_there, told) = why(json!({"segments": plan()["segments"]})).await;
    assert!(is_there && !told.contains("not foreseen"), "{told}");
    for other in [
        json!({"loads": [{"gravity_m_per_s2": [0, 0, -9.81]}]}),
        json!({"prescribed": [{"nodes": {"node_set": "z_max"}, "displacement_mm": [null, 2, null]}]}),
        json!({}),
    ] {
        let mut plan = if other == json!({}) { plan() } else { other };
        plan["segments"] = self::plan()["segments"].clone();
        let (is_there, told) = why(plan).await;
        assert!(!is_there && told.contains("not foreseen here: movements of segments"), "{told}");
    }
}

#[tokio::test]
async fn an_inverse_plan_holds_growth_and_activations_and_gives_them_back() {
    let server = Server::start();
    let case = case(&server).await;
    let spec = json!({"kind": "optimise", "case": case,
        "growth": plan()["growth"], "activations": plan()["activations"],
        "targets": [{"nodes": {"node_set": "z_max"}, "displacement_mm": [0, 0.5, 0.2]}],
        "bounds": {"left": {"translation_mm": [[-5, 5], [-5, 5], [-5, 5]]}}});
    let job = done(&server, &spec).await;
    let found = &job["results"]["optimisation"];
    assert_eq!(found["plan"]["growth"], plan()["growth"]);
    assert_eq!(found["plan"]["activations"], plan()["activations"]);
    // The full solution of that plan has growth and the muscle too.
    assert!(found["verified_difference_mm"].as_f64().unwrap() < 1e-4, "{found}");
    let mut without = spec.clone();
    without["growth"] = json!([]);
    without["activations"] = json!([]);
    let other = done(&server, &without).await;
    let other = &other["results"]["optimisation"]["plan"]["segments"];
    assert_ne!(&found["plan"]["segments"], other, "what is held changes the plan that is found");
}

#[tokio::test]
async fn what_is_not_known_of_growth_and_muscles_is_refused_with_its_place() {
    let server = Server::start();
    let case = case(&server).await;
    let predict = |plan: Value, method: &str| json!({"kind": "predict", "case": case, "plan": plan, "method": method});
    let growing = |region: &str, change: f64| json!({"growth": [{"region": region, "volume_change": change}]});
    let pulling = |muscle: &str, stress: f64| json!({"activations": [{"muscle": muscle, "stress_kpa": stress}]});
    let linear = "fem_linear";
    for (spec, code, pointer) in [
        (predict(growing("fat", 0.1), linear), "unknown-region", "/plan/growth/0/region"),
        (predict(growing("*", -0.6), linear), "out-of-range", "/plan/growth/0/volume_change"),
        (predict(pulling("jaw", 1.0), linear), "unknown-muscle", "/plan/activations/0/muscle"),
        (predict(pulling("strap", -1.0), linear), "out-of-range", "/plan/activations/0/stress_kpa"),
        (predict(growing("*", 0.1), "dvs"), "method-not-available", "/plan/growth"),
        (predict(pulling("strap", 1.0), "dvs"), "method-not-available", "/plan/activations"),
        (
            json!({"kind": "response", "case": case, "growth": ["fat"]}),
            "unknown-region",
            "/growth/0",
        ),
        (
            json!({"kind": "response", "case": case, "muscles": ["jaw"]}),
            "unknown-muscle",
            "/muscles/0",
        ),
        (
            json!({"kind": "response", "case": case, "order": 2, "muscles": ["strap"]}),
            "method-not-available",
            "/order",
        ),
    ] {
        let answer = server.job(&spec).await;
        let problem = answer.expect(StatusCode::UNPROCESSABLE_ENTITY);
        let told = &problem["errors"][0];
        assert_eq!((&told["code"], &told["pointer"]), (&json!(code), &json!(pointer)), "{spec}");
    }
    // A response without a column of it.
    done(&server, &json!({"kind": "response", "case": case, "muscles": ["slab"]})).await;
    for (plan, pointer) in [
        (growing("*", 0.1), "/plan/growth/0/region"),
        (pulling("strap", 1.0), "/plan/activations/0/muscle"),
    ] {
        let problem = apply(&server, &case, &plan).await.expect(StatusCode::UNPROCESSABLE_ENTITY);
        let told = &problem["errors"][0];
        assert_eq!((&told["code"], &told["pointer"]), (&json!("not-in-response"), &json!(pointer)));
    }
}

#[tokio::test]
async fn a_muscle_that_stiffens_is_left_out_of_a_response_and_named() {
    let server = Server::start();
    let mut case = block(json!([
        strap(),
        {"name": "stiff", "direction": [1, 0, 0],
         "box_mm": {"centre": [30, 30, 15], "half_axes": [[20, 0, 0], [0, 15, 0], [0, 0, 8]]},
         "material": {"young_modulus_kpa": 60, "poisson_ratio": 0.45, "fibre": {"young_modulus_kpa": 200}},
         "stiffening": {"young_modulus_kpa": 600, "stress_kpa": 50}},
    ]));
    // Few: the shares of cells decide nothing here.
    case["muscle_mixing"] = json!({"rule": "voigt", "samples": 8});
    let case = posted(&server, &case).await;
    let built = done(&server, &json!({"kind": "response", "case": case})).await;
    let told = built["results"]["warnings"].as_array().unwrap();
    let told = told.iter().find(|own| own["code"] == "muscle-not-linear").expect("a warning");
    assert!(told["detail"].as_str().unwrap().contains("stiff"), "{told}");
    let pulling = |muscle: &str| json!({"activations": [{"muscle": muscle, "stress_kpa": 5.0}]});
    apply(&server, &case, &pulling("strap")).await.expect(StatusCode::OK);
    let refused = apply(&server, &case, &pulling("stiff")).await;
    refused.problem(422, "not-in-response");
    // Stated, it is refused at its place, here and by inverse planning.
    let optimise = json!({"kind": "optimise", "case": case, "activations": [{"muscle": "strap", "stress_kpa": 1}, {"muscle": "stiff", "stress_kpa": 0}],
        "targets": [{"point_mm": [30, 30, 30], "displacement_mm": [null, null, 1]}],
        "bounds": {"left": {"translation_mm": [[0, 0], [0, 0], [-5, 5]]}}});
    for (spec, pointer) in [
        (json!({"kind": "response", "case": case, "muscles": ["strap", "stiff"]}), "/muscles/1"),
        (optimise, "/activations/1/muscle"),
    ] {
        let problem = server.job(&spec).await.problem(422, "not-linear");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    }
}

#[tokio::test]
async fn auto_knows_what_linear_elasticity_leaves_out_of_growth_and_muscles() {
    let server = Server::start();
    let case = case(&server).await;
    let spec = json!({"kind": "predict", "case": case, "plan": plan(), "method": "auto", "accept_mm": 0.001});
    let job = done(&server, &spec).await;
    let results = &job["results"];
    assert_eq!(results["adequacy"]["taken"], "second_order", "{results}");
    assert!(results["adequacy"]["linearity_mm"].as_f64().is_some_and(|left| left > 0.01));
    let third_order = &results["adequacy"]["third_order_mm"];
    assert_eq!(results["nonlinearity_mm"]["skin"]["mean"], *third_order, "{results}");
    let warnings = results["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|told| told["code"] == "tolerance-not-met"), "{results}");
}

#[tokio::test]
async fn a_report_says_what_its_numbers_were_computed_with() {
    let server = Server::start();
    let case = case(&server).await;
    let acts = ["volume of all tissue -5 %", "strap pulls with 5 kPa", "gains or loses volume"];
    let second = ["its term of second order", "Estimated error of the second-order model"];
    let finite = ["hyperelastic solid at finite strain", "its other errors are not estimated"];
    let linear = ["linear elastic solid at small strain", "Estimated linearisation error (model)"];
    let added = ["The estimated discretisation error was added"];
    let ways = [
        (
            json!({"method": "auto", "accept_mm": 0.001}),
            [&second[..], &acts[..]].concat(),
            linear[1],
        ),
        (json!({"method": "fem_nonlinear"}), [&finite[..], &acts[..]].concat(), linear[1]),
        (json!({"method": "fem_linear"}), [&linear[..], &acts[..]].concat(), added[0]),
        (json!({"method": "fem_linear", "corrected": true}), added.to_vec(), second[1]),
    ];
    for (way, says, says_not) in ways {
        let mut spec = json!({"kind": "predict", "case": case, "plan": plan()});
        spec.as_object_mut().unwrap().extend(way.as_object().unwrap().clone());
        let job = done(&server, &spec).await;
        let path = format!("/v1/jobs/{}/results/report.html?lang=en", job["id"].as_str().unwrap());
        let report = String::from_utf8(ask(server.get(&path)).await.bytes).unwrap();
        for words in says {
            assert!(report.contains(words), "{way}: {words}");
        }
        assert!(!report.contains(says_not), "{way}: {says_not}");
    }
}
