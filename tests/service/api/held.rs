//! What holds a face and what moves it, over HTTP: nothing that stays, walls that bones carry, plans that move nothing.

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Cells, Frame, Vector, VolumeMesh};
use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

async fn kept(server: &Server, case: &Value) -> String {
    let answer = ask(server.post("/v1/cases").multipart(SMALL.form(case))).await;
    answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
}

async fn apply(server: &Server, case: &str, plan: &Value) -> Answer {
    let path = format!("/v1/cases/{case}/response/apply");
    ask(server.post(&path).json(&json!({"plan": plan}))).await
}

fn codes(warnings: &Value) -> Vec<&str> {
    let warnings = warnings.as_array().unwrap().iter();
    warnings.map(|warning| warning["code"].as_str().unwrap()).collect()
}

fn shifted(names: &[&str]) -> Value {
    let segment = |name: &&str| json!({"name": name, "translation_mm": [5, 0, 0]});
    json!({"segments": names.iter().map(segment).collect::<Vec<_>>()})
}

#[tokio::test]
async fn a_face_with_nothing_that_stays_is_refused_on_every_way_unless_that_is_allowed() {
    let server = Server::start();
    let mut document = SMALL.case();
    document["fixed"] = json!([]);
    document["skin"] = json!({"node_set": "x_max"});
    let case = kept(&server, &document).await;
    let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&json!({}))).await;
    assert!(codes(&checked.expect(StatusCode::OK)["warnings"]).contains(&"nothing-held"));
    let moved = json!({"plan": shifted(&["bone"])});
    let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&moved)).await;
    checked.problem(422, "nothing-held");
    let target = json!([{"nodes": {"node_set": "x_max"}, "displacement_mm": [1, 0, 0]}]);
    let bounds = json!({"bone": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}});
    let optimise = json!({"kind": "optimise", "case": case, "targets": target, "bounds": bounds});
    let response = json!({"kind": "response", "case": case});
    for spec in [&spec(&case, 5.0), &response, &optimise] {
        let refused = ask(server.post("/v1/jobs").json(spec)).await;
        let problem = refused.problem(422, "nothing-held");
        assert!(problem["detail"].as_str().unwrap().contains("allow_unfixed"), "{problem}");
    }

    document["allow_unfixed"] = json!(true);
    let case = kept(&server, &document).await;
    let done = server.job(&spec(&case, 5.0)).await.expect(StatusCode::OK);
    let skin = &done["results"]["statistics"]["skin"]["nodes"];
    assert!((skin["mean"].as_f64().unwrap() - 5.0).abs() < 1e-6, "{skin}");
    server.job(&json!({"kind": "response", "case": case})).await.expect(StatusCode::OK);
    apply(&server, &case, &shifted(&["bone"])).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_response_of_two_bones_refuses_the_plans_that_a_prediction_refuses() {
    let server = Server::start();
    let mut document = SMALL.case();
    document["fixed"] = json!([]);
    document["skin"] = json!({"node_set": "x_max"});
    document["segments"] = json!([
        {"name": "lower", "nodes": {"node_set": "z_min"}},
        {"name": "upper", "nodes": {"node_set": "z_max"}},
    ]);
    let case = kept(&server, &document).await;
    let built = server.job(&json!({"kind": "response", "case": case})).await;
    let built = built.expect(StatusCode::OK);
    assert!(codes(&built["results"]["warnings"]).contains(&"nothing-held"), "{built}");
    apply(&server, &case, &shifted(&["lower", "upper"])).await.problem(422, "nothing-held");
    let mut far = shifted(&["lower"]);
    far["segments"][0]["translation_mm"] = json!([91, 0, 0]);
    apply(&server, &case, &far).await.problem(422, "plan-out-of-range");
    far["segments"] = json!([{"name": "upper"}, {"name": "lower"}]);
    for (index, x) in [1.0, 91.0].into_iter().enumerate() {
        far["segments"][index]["matrix4x4"] =
            json!([1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    }
    let problem = apply(&server, &case, &far).await.problem(422, "plan-out-of-range");
    assert_eq!(problem["errors"][0]["pointer"], "/plan/segments/1", "{problem}");
    far = shifted(&["lower"]);
    let told = apply(&server, &case, &shifted(&["lower"])).await.expect(StatusCode::OK);
    assert!(!codes(&told["warnings"]).contains(&"nothing-moves"));
    let still = apply(&server, &case, &json!({"segments": []})).await.expect(StatusCode::OK);
    assert_eq!(codes(&still["warnings"])[0], "nothing-moves");
    far["segments"][0]["translation_mm"] = json!([0.004, 0, 0]);
    let metres = apply(&server, &case, &far).await.expect(StatusCode::OK);
    assert_eq!(metres["warnings"][0]["code"], "plan-units-suspect");
    assert!((metres["warnings"][0]["if_metres_mm"].as_f64().unwrap() - 4.0).abs() < 1e-9);
}

#[tokio::test]
async fn a_plan_that_moves_nothing_and_one_in_metres_say_so() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    for (x, code) in [(0.0, "nothing-moves"), (0.005, "plan-units-suspect")] {
        let done = server.job(&spec(&case, x)).await.expect(StatusCode::OK);
        assert!(codes(&done["results"]["warnings"]).contains(&code), "{done}");
    }
    let done = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let warnings = codes(&done["results"]["warnings"]);
    assert!(!warnings.contains(&"nothing-moves") && !warnings.contains(&"plan-units-suspect"));
}

#[tokio::test]
async fn constants_in_another_unit_are_reported_and_those_no_unit_explains_are_refused() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut spec = spec(&case, 1.0);
    spec["materials"] = json!({"*": {"young_modulus_kpa": 1e-170}});
    let problem = ask(server.post("/v1/jobs").json(&spec)).await.problem(422, "validation-failed");
    let error = &problem["errors"][0];
    assert_eq!(error["code"], "out-of-range", "{problem}");
    assert!(error["detail"].as_str().unwrap().contains("at least 1e-9"), "{problem}");
    spec["materials"] = json!({"*": {"young_modulus_kpa": 0.015}});
    let done = server.job(&spec).await.expect(StatusCode::OK);
    let warnings = done["results"]["warnings"].as_array().unwrap();
    let told = warnings.iter().find(|warning| warning["code"] == "constant-suspect").unwrap();
    assert_eq!(told["value"], 0.015);
}

/// The bone at the bottom, teeth at one side that belong to it.
fn with_teeth(segment: Option<&str>) -> Value {
    let mut document = SMALL.case();
    document["skin"] = json!({"node_set": "x_max"});
    document["sliding"] = json!([{"nodes": {"node_set": "x_min"}}]);
    if let Some(segment) = segment {
        document["sliding"][0]["segment"] = json!(segment);
    }
    document
}

#[tokio::test]
async fn a_wall_goes_with_its_bone_in_predictions_and_responses_alike() {
    let server = Server::start();
    let case = kept(&server, &with_teeth(Some("bone"))).await;
    let stays = kept(&server, &with_teeth(None)).await;
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [3, 0, 0],
        "rotation_deg": [0, 6, 0], "pivot_mm": [30, 30, 0]}]});
    let mut means = Vec::new();
    for case in [&case, &stays] {
        let predict =
            json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan});
        let direct = server.job(&predict).await.expect(StatusCode::OK);
        server.job(&json!({"kind": "response", "case": case})).await.expect(StatusCode::OK);
        let told = apply(&server, case, &plan).await.expect(StatusCode::OK);
        let largest = &direct["results"]["statistics"]["skin"]["nodes"]["max"];
        let apart = told["max_mm"].as_f64().unwrap() - largest.as_f64().unwrap();
        assert!(apart.abs() < 1e-4, "{told}");
        let mean = &direct["results"]["statistics"]["skin"]["nodes"]["mean"];
        means.push(mean.as_f64().unwrap());
        let is_carried = case != &stays;
        assert_eq!(told["nonlinearity_estimate_mm"].is_null(), is_carried, "{told}");
        for warnings in [&direct["results"]["warnings"], &told["warnings"]] {
            let has_turned = codes(warnings).contains(&"sliding-normal-turned");
            assert_eq!(has_turned, is_carried, "{warnings}");
        }
        // Turned by too little for that warning, and by too much for an estimate.
        let little = json!({"segments": [{"name": "bone", "rotation_deg": [0, 1, 0], "pivot_mm": [30, 30, 0]}]});
        let told = apply(&server, case, &little).await.expect(StatusCode::OK);
        assert_eq!(told["nonlinearity_estimate_mm"].is_null(), is_carried, "{told}");
        assert_eq!(codes(&told["warnings"]).contains(&"nonlinearity-unknown"), is_carried);
        let beside = codes(&direct["results"]["warnings"]).contains(&"sliding-beside-segment");
        assert_eq!(beside, !is_carried);
    }
    assert!((means[0] - means[1]).abs() > 0.01, "{means:?}");
    let refused =
        ask(server.post("/v1/cases").multipart(SMALL.form(&with_teeth(Some("jaw"))))).await;
    let problem = refused.problem(422, "unknown-segment");
    assert_eq!(problem["errors"][0]["pointer"], "/sliding/0/segment");
}

/// One tetrahedron, two corners fixed and two joined.
fn one_tetrahedron() -> Form {
    let mut cells = Cells::default();
    cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
    let corners = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 30.0, 0.0], [0.0, 0.0, 30.0]];
    let sets = [("fix", vec![0, 1]), ("jaw", vec![2, 3]), ("skin", vec![1, 2, 3])];
    let mesh = VolumeMesh {
        nodes: corners.map(Vector::from).to_vec(),
        cells,
        node_sets: sets.map(|(name, nodes)| (name.to_owned(), nodes)).into(),
        ..VolumeMesh::default()
    };
    let case = json!({
        "units": "mm", "volume": "tissue", "skin": {"node_set": "skin"},
        "segments": [{"name": "jaw", "nodes": {"node_set": "jaw"}}], "fixed": [{"node_set": "fix"}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.45}},
    });
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap();
    Form::new().part("case", Part::text(case.to_string())).part("tissue", Part::bytes(bytes))
}

#[tokio::test]
async fn tissue_without_a_free_node_is_answered_by_every_kind_of_job() {
    let server = Server::start();
    let posted = server.post("/v1/cases?allow_any_scale=true").multipart(one_tetrahedron());
    let case = ask(posted).await.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let plan = shifted(&["jaw"]);
    let target = json!([{"nodes": {"node_set": "skin"}, "displacement_mm": [1, 0, 0]}]);
    let bounds = json!({"jaw": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}});
    for spec in [
        json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan}),
        json!({"kind": "response", "case": case}),
        json!({"kind": "optimise", "case": case, "targets": target, "bounds": bounds}),
        json!({"kind": "study", "scenes": [{"case": case, "plans": [plan]}], "repeats": 1,
            "methods": ["fem_linear"], "elements": ["auto"], "truth": {"refine": 1}}),
    ] {
        let job = server.job(&spec).await.json();
        let job = server.ended(job["id"].as_str().unwrap()).await;
        assert_eq!(job["status"], "successful", "{job}");
        if job["kind"] == "predict" {
            let skin = &job["results"]["statistics"]["skin"]["nodes"];
            assert_eq!((&skin["max"], &skin["median"]), (&json!(5.0), &json!(5.0)), "{skin}");
        }
    }
}

#[tokio::test]
async fn a_bone_that_moves_along_the_only_wall_is_refused_on_every_way() {
    let server = Server::start();
    let mut document = SMALL.case();
    document["fixed"] = json!([]);
    document["skin"] = json!({"node_set": "x_max"});
    document["segments"] = json!([{"name": "bone", "nodes": {"node_set": "x_min"}}]);
    document["sliding"] = json!([{"nodes": {"node_set": "z_min"}}]);
    let case = kept(&server, &document).await;
    let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&json!({}))).await;
    let checked = checked.expect(StatusCode::OK);
    let told = checked["warnings"].as_array().unwrap().iter();
    let told = told.into_iter().find(|warning| warning["code"] == "nothing-held").unwrap();
    let words = "slide along (1, 0, 0) and (0, 1, 0)";
    assert!(told["detail"].as_str().unwrap().contains(words), "{told}");
    let plan = shifted(&["bone"]);
    let moved = json!({"plan": plan});
    let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&moved)).await;
    let problem = checked.problem(422, "nothing-held");
    assert_eq!(problem["errors"][0]["pointer"], "/case/fixed");
    assert!(problem["detail"].as_str().unwrap().starts_with("/case/fixed: "), "{problem}");
    let predict = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan});
    ask(server.post("/v1/jobs").json(&predict)).await.problem(422, "nothing-held");

    // A response knows plans across the wall, and refuses those along it.
    server.job(&json!({"kind": "response", "case": case})).await.expect(StatusCode::OK);
    apply(&server, &case, &plan).await.problem(422, "nothing-held");
    let mut across = plan.clone();
    across["segments"][0]["translation_mm"] = json!([0, 0, 3]);
    apply(&server, &case, &across).await.expect(StatusCode::OK);

    // The plan that is found is judged as any other, and so is a row of a study.
    let target = json!([{"nodes": {"node_set": "x_max"}, "displacement_mm": [2, 0, 0]}]);
    let bounds = json!({"bone": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}});
    let optimise = json!({"kind": "optimise", "case": case, "targets": target, "bounds": bounds});
    let study = json!({"kind": "study", "scenes": [{"case": case, "plans": [plan]}], "repeats": 1,
        "methods": ["fem_linear"], "elements": ["auto"], "truth": {"refine": 1}});
    let found = server.job(&optimise).await.json();
    let found = server.ended(found["id"].as_str().unwrap()).await;
    assert_eq!(found["error"]["type"], "nothing-held", "{found}");
    let posted = ask(server.post("/v1/jobs").json(&study)).await;
    if posted.status == StatusCode::CREATED {
        let ended = server.ended(posted.json()["id"].as_str().unwrap()).await;
        let report = format!("/v1/jobs/{}/report", ended["id"].as_str().unwrap());
        let report = String::from_utf8_lossy(&ask(server.get(&report)).await.bytes).into_owned();
        let told = format!("{ended} {report}");
        assert!(told.contains("nothing-held") && !told.contains("\"pass\""), "{told}");
    } else {
        posted.problem(422, "nothing-held");
    }
}

#[tokio::test]
async fn the_target_of_inverse_planning_that_is_wrong_is_named_by_its_place_in_the_request() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let target = json!([{"nodes": {"node_set": "nowhere"}, "displacement_mm": [1, 0, 0]}]);
    let bounds = json!({"bone": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}});
    let spec = json!({"kind": "optimise", "case": case, "targets": target, "bounds": bounds});
    let problem = ask(server.post("/v1/jobs").json(&spec)).await;
    let problem = problem.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/targets/0/nodes");
    assert!(problem["detail"].as_str().unwrap().starts_with("/targets/0/nodes: "), "{problem}");
}

#[tokio::test]
async fn colours_of_inverse_planning_end_where_the_spec_says() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let target = json!([{"nodes": {"node_set": "x_max"}, "displacement_mm": [0.1, 0, 0]}]);
    let bounds = json!({"bone": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}});
    let spec = json!({"kind": "optimise", "case": case, "targets": target, "bounds": bounds,
        "range_mm": 3});
    for verify in [true, false] {
        let mut spec = spec.clone();
        spec["verify"] = json!(verify);
        let done = server.job(&spec).await.json();
        let done = server.ended(done["id"].as_str().unwrap()).await;
        let path = format!("/v1/jobs/{}/results/skin.glb", done["id"].as_str().unwrap());
        let file = ask(server.get(&path)).await;
        let text = String::from_utf8_lossy(&file.bytes).into_owned();
        assert!(text.contains("\"range\":[0.0,3.0]"), "{done}");
    }
    let mut wrong = spec.clone();
    wrong["range_mm"] = json!(0);
    let problem = ask(server.post("/v1/jobs").json(&wrong)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/range_mm");
}
