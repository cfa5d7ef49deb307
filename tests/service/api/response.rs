//! Plan responses over HTTP: built once, applied many times, refused when they do not fit.

use std::collections::BTreeSet;

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use reqwest::StatusCode;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};

use crate::helpers::{Answer, Block, SMALL, Server, ask};

const OCTETS: &str = "application/octet-stream";

/// A block with two bones under its ends, the lower of the sides along a wall.
async fn case(server: &Server) -> String {
    let mut case = SMALL.case();
    case["skin"] = json!({"node_set": "z_max"});
    case["segments"] = json!([
        {"name": "left", "nodes": {"node_set": "x_min"}},
        {"name": "right", "nodes": {"node_set": "x_max"}},
    ]);
    case["fixed"] = json!([{"node_set": "z_min"}]);
    case["sliding"] = json!([{"nodes": {"node_set": "y_min"}}]);
    kept(server, &SMALL, &case).await
}

async fn kept(server: &Server, block: &Block, case: &Value) -> String {
    let answer = ask(server.post("/v1/cases").multipart(block.form(case))).await;
    answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
}

async fn built(server: &Server, spec: Value) -> Value {
    let job = server.job(&spec).await.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    job
}

/// 25 mm and 30 degrees of the left bone, something else of the right one.
fn plan() -> Value {
    json!({"segments": [
        {"name": "right", "translation_mm": [3, -2, 1]},
        {"name": "left", "translation_mm": [15, 20, 0], "rotation_deg": [0, 30, 0], "pivot_mm": [0, 30, 15]},
    ]})
}

async fn apply(server: &Server, case: &str, plan: &Value, accept: &str) -> Answer {
    let path = format!("/v1/cases/{case}/response/apply");
    ask(server.post(&path).header("accept", accept).json(&json!({"plan": plan}))).await
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    let (values, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    values.iter().map(|&value| f32::from_le_bytes(value)).collect()
}

/// node_id to displacement, from the lines of `skin.csv`.
fn predicted(text: &str) -> Vec<(u32, [f64; 3])> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|other| *other == name).unwrap();
    let id = column("node_id");
    let axes = ["ux_mm", "uy_mm", "uz_mm"].map(column);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[id].parse().unwrap(), axes.map(|axis| cells[axis].parse().unwrap()))
    };
    lines.map(row).collect()
}

fn warnings_of(told: &Value) -> impl Iterator<Item = &Value> {
    told["warnings"].as_array().unwrap().iter()
}

/// What a result tells of torn tissue, but for the count of cells, which a response does not know.
fn tearing_of(told: &Value) -> Option<Value> {
    let mut numbers = warnings_of(told).find(|warning| warning["code"] == "tearing")?.clone();
    numbers.as_object_mut().unwrap().retain(|name, _| name != "detail" && name != "turned_cells");
    Some(numbers)
}

#[tokio::test]
async fn a_plan_applied_to_a_response_tears_the_tissue_where_its_prediction_does() {
    let server = Server::start();
    // The left bone meets the bottom, which stays; the right one is left out of the response, and stays as well.
    let case = case(&server).await;
    built(&server, json!({"kind": "response", "case": case, "segments": ["left"]})).await;
    let by = |x: f64, y: f64| json!({"segments": [{"name": "left", "translation_mm": [x, y, 0]}]});
    for (plan, tears, turns) in
        [(by(5.0, 0.0), false, false), (by(-16.0, 0.0), true, false), (by(16.0, 3.0), true, true)]
    {
        let applied = apply(&server, &case, &plan, "application/json").await;
        let applied = applied.expect(StatusCode::OK);
        let told = tearing_of(&applied);
        assert_eq!(told.is_some(), tears, "{plan}: {applied}");
        assert_eq!(told.as_ref().is_some_and(|told| told.get("turned_edges").is_some()), turns);
        let spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan, "outputs": ["skin.csv"]});
        let direct = built(&server, spec).await;
        assert_eq!(told, tearing_of(&direct["results"]), "{plan}");
    }
}

#[tokio::test]
async fn what_a_prediction_warns_of_is_told_by_a_response_or_named_as_not_looked_for() {
    let server = Server::start();
    let mut case = SMALL.case();
    case["skin"] = json!({"node_set": "z_max"});
    case["segments"] = json!([{"name": "left", "nodes": {"node_set": "x_min"}}]);
    case["fixed"] = json!([{"node_set": "x_max"}]);
    case["landmarks"] = json!({"astray": [0, 0, 400]});
    let case = kept(&server, &SMALL, &case).await;
    built(&server, json!({"kind": "response", "case": case})).await;
    let shifted = json!({"segments": [{"name": "left", "translation_mm": [-15, 20, 0]}]});
    let turned = json!({"segments": [
        {"name": "left", "rotation_deg": [0, 30, 0], "pivot_mm": [0, 30, 15]}]});
    let mut of_predictions = BTreeSet::new();
    for plan in [shifted, turned] {
        let applied = apply(&server, &case, &plan, "application/json").await;
        let applied = applied.expect(StatusCode::OK);
        let told = warnings_of(&applied).map(|told| told["code"].as_str().unwrap().to_owned());
        let mut known: BTreeSet<String> = told.collect();
        let unmeasured: Vec<String> =
            serde_json::from_value(applied["not_measured"].clone()).unwrap();
        known.extend(unmeasured);
        let spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan, "outputs": ["skin.csv"]});
        let direct = built(&server, spec).await;
        for warning in warnings_of(&direct["results"]) {
            let code = warning["code"].as_str().unwrap();
            assert!(known.contains(code), "{code} of {plan} is not among {known:?}");
            of_predictions.insert(code.to_owned());
        }
    }
    assert!(of_predictions.contains("landmark-far"), "{of_predictions:?}");
    let beyond = ["large-rotation", "large-strain"];
    assert!(beyond.iter().any(|&code| of_predictions.contains(code)), "{of_predictions:?}");
}

#[tokio::test]
async fn a_plan_applied_to_a_response_is_the_prediction_of_that_plan() {
    let server = Server::start();
    let case = case(&server).await;
    let job = built(&server, json!({"kind": "response", "case": case})).await;
    let mut spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan(), "outputs": ["skin.csv"]});
    spec["tolerance"] = json!({"relative_residual": 1e-12});
    let direct = built(&server, spec).await;
    let path = format!("/v1/jobs/{}/results/skin.csv", direct["id"].as_str().unwrap());
    let text = String::from_utf8(ask(server.get(&path)).await.bytes).unwrap();
    let exact = predicted(&text);

    let answer = apply(&server, &case, &plan(), "application/json").await;
    let told = answer.expect(StatusCode::OK);
    let ids: Vec<u32> = serde_json::from_value(told["node_ids"].clone()).unwrap();
    let moved: Vec<[f64; 3]> = serde_json::from_value(told["displacement_mm"].clone()).unwrap();
    assert_eq!(ids, exact.iter().map(|(id, _)| *id).collect::<Vec<_>>());
    let mut largest: f64 = 0.0;
    for (moved, (_, exact)) in moved.iter().zip(&exact) {
        let difference: f64 = moved.iter().zip(exact).map(|(u, v)| (u - v).powi(2)).sum();
        assert!(difference.sqrt() < 1e-4, "{moved:?} {exact:?}");
        largest = largest.max(exact.iter().map(|v| v * v).sum::<f64>().sqrt());
    }
    assert!((told["max_mm"].as_f64().unwrap() - largest).abs() < 1e-4);
    assert!((told["largest_rotation_deg"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    assert_eq!(told["within_linear_range"], false);
    let codes: Vec<&str> = warnings_of(&told).map(|of| of["code"].as_str().unwrap()).collect();
    assert_eq!(codes[..2], ["tearing", "outside-linear-range"], "the gravest first");
    assert_eq!(told["job"], job["id"]);
    assert!(answer.header("server-timing").contains("apply;dur="));

    // The same numbers as octets, with the rest as headers.
    let octets = apply(&server, &case, &plan(), OCTETS).await;
    assert_eq!((octets.status, octets.header("content-type")), (StatusCode::OK, OCTETS));
    let values: Vec<f32> = floats(&octets.bytes);
    assert_eq!(values.len(), 3 * ids.len());
    let flat = moved.as_flattened();
    assert!(values.iter().zip(flat).all(|(value, other)| *value == *other as f32));
    let told_mm: f64 = octets.header("facies-max-mm").parse().unwrap();
    assert_eq!(told_mm, told["max_mm"].as_f64().unwrap());
    assert_eq!(octets.header("facies-job"), job["id"].as_str().unwrap());
    assert_eq!(octets.header("facies-within-linear-range"), "false");
    let codes = octets.header("facies-warning");
    assert!(codes.starts_with("tearing, outside-linear-range, default-material"), "{codes}");
}

#[tokio::test]
async fn the_columns_are_served_in_ranges_and_give_the_same_skin_to_who_adds_them_up() {
    let server = Server::start();
    let case = case(&server).await;
    let job = built(&server, json!({"kind": "response", "case": case})).await;
    let path = format!("/v1/cases/{case}/response");
    let description = ask(server.get(&path)).await;
    let told = description.expect(StatusCode::OK);
    assert_eq!((&told["job"], &told["key"]), (&job["id"], &job["spec_hash"]));
    let whole = ask(server.get(&path).header("accept", OCTETS)).await;
    assert_eq!((whole.status, whole.header("content-type")), (StatusCode::OK, OCTETS));
    assert_eq!(
        whole.header("etag"),
        format!("\"{}\"", told["columns"]["sha256"].as_str().unwrap())
    );
    let columns = floats(&whole.bytes);
    let nodes = told["node_ids"].as_array().unwrap().len();
    assert_eq!(columns.len(), 24 * 3 * nodes);

    // What a front end does: a translation along z is column 12 s + 11 times its length.
    let shift = json!({"segments": [{"name": "right", "translation_mm": [0, 0, 2.0]}]});
    let applied = floats(&apply(&server, &case, &shift, OCTETS).await.bytes);
    let column = &columns[(12 + 11) * 3 * nodes..][..3 * nodes];
    assert!(applied.iter().zip(column).all(|(u, c)| *u == 2.0 * c));

    for (accept, all) in [(OCTETS, &whole), ("application/json", &description)] {
        let tag = all.header("etag").to_owned();
        let ask_for = |name: &'static str, value: &str| {
            ask(server.get(&path).header("accept", accept).header(name, value.to_owned()))
        };
        let known = ask_for("if-none-match", &tag).await;
        assert_eq!((known.status, known.bytes.len()), (StatusCode::NOT_MODIFIED, 0));
        let part = ask_for("range", "bytes=5-9").await;
        assert_eq!(
            (part.status, &part.bytes[..]),
            (StatusCode::PARTIAL_CONTENT, &all.bytes[5..=9])
        );
        ask_for("range", "bytes=99999999-").await.problem(416, "range-not-satisfiable");
    }
    ask(server.get(&path).header("accept", "image/png")).await.problem(406, "not-acceptable");
    let files = job["results"]["files"].as_array().unwrap();
    let names: Vec<&str> = files.iter().map(|file| file["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["response.f32", "response.json", "skin_at_rest.vtp"]);
}

#[tokio::test]
async fn the_moved_skin_is_readable_as_gltf() {
    let server = Server::start();
    let case = case(&server).await;
    built(&server, json!({"kind": "response", "case": case})).await;
    let shift = json!({"segments": [{"name": "left", "translation_mm": [2, 0, 0]}]});
    let answer = apply(&server, &case, &shift, "model/gltf-binary").await;
    assert_eq!(
        (answer.status, answer.header("content-type")),
        (StatusCode::OK, "model/gltf-binary")
    );
    assert_eq!(&answer.bytes[..4], b"glTF");
    let number =
        |at: usize| u32::from_le_bytes(answer.bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(number(8), answer.bytes.len());
    let text = &answer.bytes[20..20 + number(12)];
    let document: Value = serde_json::from_slice(text).unwrap();
    let positions = &document["accessors"][1];
    assert_eq!(positions["count"], 25);
    // The corner of the block at x = 60 mm stays, the one at 0 moves to 2 mm.
    assert!((positions["min"][0].as_f64().unwrap() - 0.002).abs() < 1e-6);
    assert!((positions["max"][0].as_f64().unwrap() - 0.060).abs() < 1e-6);
    assert_eq!(answer.header("facies-within-linear-range"), "true");
}

#[tokio::test]
async fn a_response_is_built_once_and_goes_with_its_case() {
    let server = Server::start();
    let case = case(&server).await;
    let missing = apply(&server, &case, &plan(), OCTETS).await;
    missing.problem(404, "response-not-built");
    let path = format!("/v1/cases/{case}/response");
    ask(server.get(&path)).await.problem(404, "response-not-built");
    let unknown = "01890000-0000-7000-8000-000000000000";
    apply(&server, unknown, &plan(), OCTETS).await.problem(404, "not-found");

    let first = built(&server, json!({"kind": "response", "case": case})).await;
    let again = json!({"kind": "response", "case": case, "tags": ["again"], "method": "auto"});
    let again = server.job(&again).await.expect(StatusCode::OK);
    assert_eq!((&again["id"], &again["deduplicated"]), (&first["id"], &json!(true)));
    // Another element, a membrane or other materials are other responses, which answer where they are named, or where there
    // is none of the case alone.
    built(&server, json!({"kind": "response", "case": case, "element": "plain"})).await;
    built(&server, json!({"kind": "response", "case": case, "membrane": {}})).await;
    let soft = json!({"*": {"young_modulus_kpa": 5, "poisson_ratio": 0.3}});
    let other = built(&server, json!({"kind": "response", "case": case, "materials": soft})).await;
    assert_ne!(other["id"], first["id"]);
    let own = apply(&server, &case, &plan(), OCTETS).await;
    assert_eq!(own.header("facies-job"), first["id"].as_str().unwrap());
    let named = |job: &str| {
        let path = format!("/v1/cases/{case}/response/apply?job={job}");
        ask(server.post(&path).header("accept", OCTETS).json(&json!({"plan": plan()})))
    };
    let with_others = named(other["id"].as_str().unwrap()).await;
    assert_eq!(with_others.header("facies-job"), other["id"].as_str().unwrap());
    assert_ne!(with_others.bytes, own.bytes);
    for job in [unknown, "nonsense"] {
        named(job).await.problem(404, "response-not-built");
    }
    let removed = ask(server.delete(&format!("/v1/jobs/{}", first["id"].as_str().unwrap()))).await;
    assert_eq!(removed.status, StatusCode::NO_CONTENT);
    let left = apply(&server, &case, &plan(), OCTETS).await;
    assert!(left.header("facies-warning").contains("other-response"), "it was not asked for");
    assert!(!with_others.header("facies-warning").contains("other-response"));
    assert_eq!((left.status, left.bytes), (StatusCode::OK, with_others.bytes));

    let erased = ask(server.delete(&format!("/v1/cases/{case}")).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    apply(&server, &case, &plan(), OCTETS).await.problem(410, "gone");
    let job = format!("/v1/jobs/{}", other["id"].as_str().unwrap());
    ask(server.get(&job)).await.problem(410, "gone");
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap();
    let left = blobs.flat_map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap()).count();
    assert_eq!(left, 0, "nothing of the case is left on the disk");
}

#[tokio::test]
async fn responses_by_other_means_of_other_clients_do_not_stand_for_the_usual_one() {
    let server = Server::start();
    // Enough unknowns to be iterated.
    let case = server.case(&Block { cells: [16, 16, 10] }).await;
    let usual = built(&server, json!({"kind": "response", "case": case})).await;
    let with = |member: &str, value: Value| {
        let mut spec = json!({"kind": "response", "case": case});
        spec[member] = value;
        spec
    };
    let tight = json!({"relative_residual": 1e-10});
    let tight = built(&server, with("tolerance", tight)).await;
    assert_ne!(tight["id"], usual["id"]);
    let loose = json!({"relative_residual": 1e-2});
    let loose = built(&server, with("tolerance", loose)).await;
    let shift = json!({"segments": [{"name": "bone", "translation_mm": [2, 0, 0]}]});
    let taken = apply(&server, &case, &shift, OCTETS).await;
    assert_eq!(taken.header("facies-job"), tight["id"].as_str().unwrap());
    assert!(!taken.header("facies-warning").contains("solved-loosely"));
    let path = format!("/v1/cases/{case}/response");
    let shown = ask(server.get(&path)).await.expect(StatusCode::OK);
    assert_eq!(shown["job"], tight["id"]);
    let named = format!("{path}/apply?job={}", loose["id"].as_str().unwrap());
    let named = ask(server.post(&named).json(&json!({"plan": shift}))).await;
    let told = named.expect(StatusCode::OK);
    let told = warnings_of(&told).find(|told| told["code"] == "solved-loosely").unwrap();
    assert!(told["relative_residual"].as_f64().unwrap() > 1e-6, "{told}");
}

#[tokio::test]
async fn of_the_usual_responses_one_that_moves_what_the_plan_moves_is_taken() {
    let server = Server::start();
    let case = case(&server).await;
    let all = built(&server, json!({"kind": "response", "case": case})).await;
    let part = json!({"kind": "response", "case": case, "segments": ["left"], "growth": ["*"]});
    let part = built(&server, part).await;
    let shift = |name: &str| json!({"segments": [{"name": name, "translation_mm": [1, 0, 0]}]});
    let grown = json!({"growth": [{"region": "*", "volume_change": 0.02}]});
    for (plan, job) in [(shift("right"), &all), (shift("left"), &part), (grown, &part)] {
        let taken = apply(&server, &case, &plan, OCTETS).await;
        assert_eq!(taken.status, StatusCode::OK, "{plan}");
        assert_eq!(taken.header("facies-job"), job["id"].as_str().unwrap(), "{plan}");
    }
    let shown = ask(server.get(&format!("/v1/cases/{case}/response"))).await;
    assert_eq!(shown.header("facies-job"), all["id"].as_str().unwrap());
}

#[tokio::test]
async fn a_response_of_a_case_that_changed_is_stale() {
    let server = Server::start();
    let case = case(&server).await;
    let job = built(&server, json!({"kind": "response", "case": case})).await;
    assert_eq!(apply(&server, &case, &plan(), OCTETS).await.status, StatusCode::OK);
    let options = SqliteConnectOptions::new().filename(server.path().join("facies.db"));
    let database = SqlitePool::connect_with(options).await.unwrap();
    let change = |field: &'static str, value: Value| {
        let (database, case) = (database.clone(), case.clone());
        async move {
            sqlx::query(
                "UPDATE cases SET version = version + 1, document = json_set(document, $1, json($2)) WHERE id = $3",
            )
            .bind(field)
            .bind(value.to_string())
            .bind(case)
            .execute(&database)
            .await
            .unwrap();
        }
    };
    // A name, tags and landmarks change no column.
    change("$.landmarks", json!({"tip": [1, 2, 3]})).await;
    assert_eq!(apply(&server, &case, &plan(), OCTETS).await.status, StatusCode::OK);
    change("$.materials", json!({"*": {"young_modulus_kpa": 5, "poisson_ratio": 0.3}})).await;
    let stale = apply(&server, &case, &plan(), OCTETS).await.problem(409, "response-stale");
    assert_eq!(stale["job"], job["id"]);
    let path = format!("/v1/cases/{case}/response?job={}", job["id"].as_str().unwrap());
    ask(server.get(&path)).await.problem(409, "response-stale");
    // Built anew, it answers again.
    built(&server, json!({"kind": "response", "case": case})).await;
    assert_eq!(apply(&server, &case, &plan(), OCTETS).await.status, StatusCode::OK);
    change("$.sliding", json!([])).await;
    apply(&server, &case, &plan(), OCTETS).await.problem(409, "response-stale");
}

#[tokio::test]
async fn a_plan_that_the_response_cannot_follow_is_refused_with_the_place() {
    let server = Server::start();
    let case = case(&server).await;
    built(&server, json!({"kind": "response", "case": case, "segments": ["left"]})).await;
    let shift =
        |name: &str, x: f64| json!({"segments": [{"name": name, "translation_mm": [x, 0, 0]}]});
    let cases = [
        ("other", shift("right", 1.0), "not-in-response", "/plan/segments/0/name"),
        ("unknown", shift("chin", 1.0), "unknown-segment", "/plan/segments/0/name"),
        ("a node set", shift("z_max", 1.0), "unknown-segment", "/plan/segments/0/name"),
        ("far", shift("left", 200.0), "plan-out-of-range", "/plan/segments/0/translation_mm"),
        (
            "prescribed",
            json!({"prescribed": [{"nodes": {"node_set": "z_max"}, "displacement_mm": [1, 0, 0]}]}),
            "not-in-response",
            "/plan/prescribed",
        ),
        (
            "loads",
            json!({"loads": [{"gravity_m_per_s2": [0, 0, -9.81]}]}),
            "not-in-response",
            "/plan/loads",
        ),
        ("frame", json!({"frame": "LPS", "segments": []}), "frame-conflict", "/plan/frame"),
    ];
    for (name, plan, code, pointer) in cases {
        let problem = apply(&server, &case, &plan, OCTETS).await.problem_of(name, 422, code);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{name}");
    }
    let bad = ask(server.post(&format!("/v1/cases/{case}/response/apply")).json(&json!({}))).await;
    bad.problem(422, "validation-failed");
    let sided = apply(&server, &case, &shift("right", 0.0), OCTETS).await;
    assert_eq!(
        sided.status,
        StatusCode::OK,
        "a segment without columns may be named when it stays"
    );
    assert!(floats(&sided.bytes).iter().all(|value| *value == 0.0));
}

#[tokio::test]
async fn a_response_that_cannot_be_built_is_refused_before_it_is_queued() {
    let server = Server::start();
    let mut document = SMALL.case();
    document["segments"] = json!([
        {"name": "bone", "nodes": {"node_set": "z_min"}},
        {"name": "side", "nodes": {"node_set": "x_min"}},
    ]);
    let shared = kept(&server, &SMALL, &document).await;
    let spec = |case: &str| json!({"kind": "response", "case": case});
    let problem = server.job(&spec(&shared)).await.problem(422, "plan-conflict");
    // The edge that both sets of the 4 x 4 x 4 block have.
    assert_eq!(
        (&problem["count"], &problem["errors"][0]["pointer"]),
        (&json!(5), &json!("/case/segments"))
    );
    document["segments"] = json!([]);
    let empty = kept(&server, &SMALL, &document).await;
    server.job(&spec(&empty)).await.problem(422, "empty-selection");

    let case = case(&server).await;
    let with = |field: &str, value: Value| {
        let mut spec = spec(&case);
        spec[field] = value;
        spec
    };
    let unknown = server.job(&with("segments", json!(["left", "chin"]))).await;
    let problem = unknown.problem(422, "unknown-segment");
    assert_eq!(problem["errors"][0]["pointer"], "/segments/1");
    let twice = server.job(&with("segments", json!(["left", "left"]))).await;
    twice.problem(422, "validation-failed");
    server.job(&with("method", json!("msm"))).await.problem(422, "method-not-available");
    let tolerance = server.job(&with("tolerance", json!({"relative_residual": 1.0}))).await;
    assert_eq!(
        tolerance.problem(422, "validation-failed")["errors"][0]["pointer"],
        "/tolerance/relative_residual"
    );
    server.job(&with("plan", json!({}))).await.problem(422, "validation-failed");
    server.job(&spec("nonsense")).await.problem(422, "validation-failed");
    let job = server.job(&with("budget", json!({"wall_s": 0.001}))).await;
    let job = job.json();
    assert_eq!(
        (&job["status"], &job["error"]["type"]),
        (&json!("failed"), &json!("budget-exceeded"))
    );
}

#[tokio::test]
async fn a_response_survives_a_memory_without_room_and_a_restart() {
    let server = Server::start_with(&["--response-cache-mib", "0"]);
    let case = case(&server).await;
    built(&server, json!({"kind": "response", "case": case})).await;
    let before = apply(&server, &case, &plan(), OCTETS).await;
    assert_eq!(before.status, StatusCode::OK);
    let (folder, _) = server.terminate();
    let server = Server::start_in(folder, &[]);
    let after = apply(&server, &case, &plan(), OCTETS).await;
    assert_eq!((after.status, after.bytes), (StatusCode::OK, before.bytes));
}

/// The JSON of a binary glTF file, and the f32 of one of its attributes.
fn gltf(bytes: &[u8], attribute: &str) -> (Value, Vec<f32>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let scene: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let number = &scene["meshes"][0]["primitives"][0]["attributes"][attribute];
    let accessor = &scene["accessors"][number.as_u64().unwrap() as usize];
    let view = &scene["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let place = |name: &str| view[name].as_u64().unwrap() as usize;
    let begin = 28 + length + place("byteOffset");
    let values = floats(&bytes[begin..begin + place("byteLength")]);
    (scene, values)
}

const GLB: &str = "model/gltf-binary";

#[tokio::test]
async fn a_skin_as_gltf_has_its_vertices_in_the_order_of_its_nodes_and_colours_that_mean_the_same()
{
    let server = Server::start();
    let case = case(&server).await;
    built(&server, json!({"kind": "response", "case": case})).await;
    let path = format!("/v1/cases/{case}/response");
    let told = ask(server.get(&path)).await.expect(StatusCode::OK);
    let ids: Vec<usize> = serde_json::from_value(told["node_ids"].clone()).unwrap();

    // The skin at rest is that of the mesh, node by node: 60 x 60 x 30 mm in 4 x 4 x 4 cells.
    let rest = ask(server.get(&path).header("accept", GLB)).await;
    assert_eq!((rest.status, rest.header("content-type")), (StatusCode::OK, GLB));
    let (scene, positions) = gltf(&rest.bytes, "POSITION");
    let (positions, _) = positions.as_chunks::<3>();
    let matrix: Vec<f64> =
        serde_json::from_value(scene["extras"]["matrix4x4_to_case_row_major"].clone()).unwrap();
    assert_eq!(positions.len(), ids.len());
    for (&node, position) in ids.iter().zip(positions) {
        let wanted = [node % 5 * 15, node / 5 % 5 * 15].map(|x| x as f64);
        let back = |row: usize| (0..3).map(|k| matrix[4 * row + k] * f64::from(position[k])).sum();
        let found: [f64; 3] = [back(0), back(1), back(2)];
        // Metres in 32 bits.
        assert!(
            (found[0] - wanted[0]).abs() < 1e-4 && (found[1] - wanted[1]).abs() < 1e-4,
            "{node}"
        );
        assert!((found[2] - 30.0).abs() < 1e-4, "{node}");
    }

    // 1 mm and 5 mm are told apart by their colours, and their values are in the file.
    let by = |mm: f64| json!({"segments": [{"name": "left", "translation_mm": [0, 0, mm]}]});
    let apply_path = format!("{path}/apply");
    let glb = async |mm: f64, query: &str| {
        let request = server.post(&format!("{apply_path}{query}")).header("accept", GLB);
        ask(request.json(&json!({"plan": by(mm)}))).await
    };
    let (small, large) = (glb(1.0, "").await.bytes, glb(5.0, "").await.bytes);
    assert_ne!(gltf(&small, "COLOR_0").1, gltf(&large, "COLOR_0").1);
    let (scene, moved) = gltf(&large, "_DISPLACEMENT_MM");
    let octets = apply(&server, &case, &by(5.0), OCTETS).await;
    assert_eq!(moved, floats(&octets.bytes));
    let scale = json!({"array": "displacement_magnitude_mm",
        "attribute": "_DISPLACEMENT_MAGNITUDE_MM", "range": [0.0, 10.0]});
    assert_eq!(scene["extras"]["colours"], scale);
    let (scene, colours) = gltf(&glb(1.0, "?range_mm=2").await.bytes, "COLOR_0");
    assert_eq!(scene["extras"]["colours"]["range"], json!([0.0, 2.0]));
    assert_eq!(colours, gltf(&glb(5.0, "").await.bytes, "COLOR_0").1, "half of each range");
    glb(1.0, "?range_mm=0").await.problem(400, "invalid-parameter");
}

/// A lip on a bone, and 1 mm above it a smaller one that is held from above.
pub(super) fn lips() -> Vec<u8> {
    let mut mesh = sample::block(Vector::new(50.0, 40.0, 6.0), [10, 8, 2], CellShape::Hex8);
    let upper = sample::block(Vector::new(23.0, 21.0, 6.0), [5, 4, 2], CellShape::Hex8);
    let first = mesh.nodes.len() as u32;
    mesh.nodes.extend(upper.nodes.iter().map(|node| node + Vector::new(8.3, 6.1, 7.0)));
    for (shape, nodes) in upper.cells.iter() {
        let nodes: Vec<u32> = nodes.iter().map(|node| node + first).collect();
        mesh.cells.push(shape, &nodes);
    }
    let ceiling = upper.node_sets["z_max"].iter().map(|node| node + first).collect();
    mesh.node_sets.insert("ceiling".to_owned(), ceiling);
    mesh.node_sets.insert("skin".to_owned(), (0..mesh.nodes.len() as u32).collect());
    vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap()
}

#[tokio::test]
async fn skin_that_passes_through_itself_is_reported_by_predictions_and_where_a_response_is_asked_to_look()
 {
    let server = Server::start();
    let upload = server.post("/v1/meshes?units=mm").header("content-type", OCTETS).body(lips());
    let mesh = ask(upload).await.expect(StatusCode::CREATED);
    // Each lip goes along with its bone as one.
    let case = json!({"units": "mm", "volume": mesh["id"], "skin": {"node_set": "skin"},
        "allow_unfixed": true, "segments": [{"name": "jaw", "nodes": {"node_set": "z_min"}}],
        "fixed": [{"node_set": "ceiling"}]});
    let case = ask(server.post("/v1/cases").json(&case)).await.expect(StatusCode::CREATED);
    let case = case["id"].as_str().unwrap().to_owned();
    built(&server, json!({"kind": "response", "case": case})).await;
    let past = json!({"segments": [{"name": "jaw", "translation_mm": [0, 0, 3]}]});
    let codes = |told: &Value| -> Vec<String> {
        let warnings = told["warnings"].as_array().unwrap().iter();
        warnings.map(|warning| warning["code"].as_str().unwrap().to_owned()).collect()
    };
    let overlaps = "skin-overlaps".to_owned();
    let spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": past, "outputs": ["skin.csv"]});
    let job = built(&server, spec).await;
    assert!(codes(&job["results"]).contains(&overlaps), "{job}");

    let path = format!("/v1/cases/{case}/response/apply");
    let ask_for = async |query: &str, accept: &str| {
        let request = server.post(&format!("{path}{query}")).header("accept", accept);
        ask(request.json(&json!({"plan": past}))).await
    };
    let unasked = ask_for("", "application/json").await.expect(StatusCode::OK);
    let of_mesh = [
        "numerical-error-large",
        "cells-inverted",
        "bones-overlap",
        "bone-in-tissue",
        "bone-through-skin",
        "large-rotation",
        "large-strain",
        "tissue-may-buckle",
        "skin-outruns-plan",
        "sliding-off-wall",
        "landmark-far",
        "landmarks-crowded",
        "landmarks-swapped",
    ];
    let without_skin = of_mesh.join(", ");
    let all: Vec<&str> = of_mesh.into_iter().chain([overlaps.as_str()]).collect();
    assert_eq!(unasked["not_measured"], json!(all));
    assert!(!codes(&unasked).contains(&overlaps));
    let asked = ask_for("?check_skin=true", "application/json").await;
    assert!(asked.header("server-timing").contains("check;dur="));
    let asked = asked.expect(StatusCode::OK);
    assert_eq!(asked["not_measured"], json!(of_mesh));
    assert!(codes(&asked).contains(&overlaps), "{asked}");
    let octets = ask_for("?check_skin=true", OCTETS).await;
    assert!(octets.header("facies-warning").split(", ").any(|code| code == "skin-overlaps"));
    let octets = ask_for("", OCTETS).await;
    assert_eq!(octets.header("facies-not-measured"), format!("{without_skin}, {overlaps}"));
}

#[tokio::test]
async fn a_response_of_order_two_adds_its_quadratic_form_and_hands_it_over() {
    let server = Server::start();
    let case = case(&server).await;
    let job = built(&server, json!({"kind": "response", "case": case, "order": 2})).await;
    let path = format!("/v1/cases/{case}/response");
    let told = ask(server.get(&path)).await.expect(StatusCode::OK).clone();
    let form = &told["second_order"];
    assert_eq!(form["columns"]["count"], 300);
    assert_eq!(form["third_order_mm"].as_array().unwrap().len(), 2);
    let scales: Vec<f64> = serde_json::from_value(form["scale_mm"].clone()).unwrap();
    let second = ask(server.get(&format!("{path}?order=2")).header("accept", OCTETS)).await;
    assert_eq!(
        second.header("etag"),
        format!("\"{}\"", form["columns"]["sha256"].as_str().unwrap())
    );
    let (values, rest) = second.bytes.as_chunks::<2>();
    let nodes = told["node_ids"].as_array().unwrap().len();
    assert!(rest.is_empty() && values.len() == 300 * 3 * nodes && scales.len() == 300);
    let first = floats(&ask(server.get(&path).header("accept", OCTETS)).await.bytes);

    // What a front end does: 4 mm along z of the right bone is number 12 + 11 of both segments, whose square is the
    // last but zero of the pairs.
    let shift = json!({"segments": [{"name": "right", "translation_mm": [0, 0, 4.0]}]});
    let answer = apply(&server, &case, &shift, "application/json").await;
    let applied = answer.expect(StatusCode::OK);
    let moved: Vec<[f64; 3]> = serde_json::from_value(applied["displacement_mm"].clone()).unwrap();
    let column = &first[23 * 3 * nodes..];
    let pair = &values[299 * 3 * nodes..];
    let (mut beyond, mut largest) = (0.0_f64, 0.0_f64);
    for ((moved, linear), square) in moved.as_flattened().iter().zip(column).zip(pair) {
        let second = 16.0 * scales[299] * f64::from(i16::from_le_bytes(*square));
        let sum = 4.0 * f64::from(*linear) + second;
        assert!((moved - sum).abs() < 1e-5, "{moved} {sum}");
        (beyond, largest) = (beyond.max(second.abs()), largest.max(moved.abs()));
    }
    assert!(beyond > 1e-3 * largest, "{beyond} of {largest}");
    assert_eq!((&applied["order"], &applied["job"]), (&json!(2), &job["id"]));
    let second_order = applied["second_order_mm"].as_f64().unwrap();
    let left = applied["nonlinearity_estimate_mm"].as_f64().unwrap();
    assert!(second_order > 0.0 && left > 0.0 && left < second_order, "{left} {second_order}");
    assert_eq!(
        (answer.header("facies-order"), &applied["within_linear_range"]),
        ("2", &json!(true))
    );
    let octets = apply(&server, &case, &shift, OCTETS).await;
    assert_eq!(octets.header("facies-second-order-mm").parse(), Ok(second_order));

    // Far beyond: the series is not to be trusted, and says so with its numbers.
    let far = json!({"segments": [{"name": "right", "translation_mm": [0, 0, 24.0]}]});
    let answer = apply(&server, &case, &far, "application/json").await;
    let applied = answer.expect(StatusCode::OK);
    assert_eq!(applied["within_linear_range"], false, "{applied}");
    assert!(warnings_of(&applied).any(|told| told["code"] == "outside-second-order-range"));
}

#[tokio::test]
async fn a_response_of_order_two_says_where_its_law_takes_volume_at_points() {
    let law = json!({"kind": "neo_hookean_isochoric", "mu_kpa": 5, "bulk_modulus_kpa": 250});
    for (order, warns) in [(1, false), (2, true)] {
        let server = Server::start();
        let mut block = SMALL.case();
        block["materials"] = json!({"*": {"law": law}});
        let case = kept(&server, &SMALL, &block).await;
        let job = built(&server, json!({"kind": "response", "case": case, "order": order})).await;
        let shift = json!({"segments": [{"name": "bone", "translation_mm": [0, 0, 1.0]}]});
        let applied = apply(&server, &case, &shift, "application/json").await;
        for told in [job["results"].clone(), applied.expect(StatusCode::OK)] {
            assert_eq!(warnings_of(&told).any(|told| told["code"] == "locking"), warns, "{told}");
        }
    }
}

#[tokio::test]
async fn a_response_of_fibres_that_only_pull_says_as_a_prediction_that_its_error_is_unknown() {
    let server = Server::start();
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [-2, 0.5, 0]}]});
    let plain = json!({"young_modulus_kpa": 20, "poisson_ratio": 0.4});
    let mut pulling = plain.clone();
    pulling["fibre"] = json!({"k1_kpa": 40, "k2": 1, "direction": [1, 0.3, 0]});
    for (material, is_known) in [(plain, true), (pulling, false)] {
        let mut block = SMALL.case();
        block["materials"] = json!({"*": material});
        let case = kept(&server, &SMALL, &block).await;
        built(&server, json!({"kind": "response", "case": case})).await;
        let applied = apply(&server, &case, &plan, "application/json").await;
        let told = applied.expect(StatusCode::OK);
        assert_eq!(told.get("nonlinearity_estimate_mm").unwrap().is_null(), !is_known, "{told}");
        let within = told.get("within_linear_range").unwrap();
        assert_eq!(within, &if is_known { json!(true) } else { json!(null) }, "{told}");
        let octets = apply(&server, &case, &plan, OCTETS).await;
        assert_eq!(octets.header("facies-within-linear-range") == "true", is_known);
        assert_eq!(octets.header("facies-within-linear-range").is_empty(), !is_known);
        let is_told = warnings_of(&told).any(|told| told["code"] == "nonlinearity-unknown");
        assert_eq!(is_told, !is_known, "{told}");
        let spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan});
        let predicted = built(&server, spec).await;
        assert_eq!(predicted["results"]["nonlinearity_mm"].is_null(), !is_known);
        // Nor is it foreseen which model `auto` takes.
        let body = json!({"plan": plan, "method": "auto"});
        let checked = ask(server.post(&format!("/v1/cases/{case}/check")).json(&body)).await;
        assert_eq!(checked.expect(StatusCode::OK).get("auto").is_some(), is_known);
    }
}

#[tokio::test]
async fn an_order_that_a_response_does_not_have_is_refused() {
    let server = Server::start();
    let case = case(&server).await;
    let third = json!({"kind": "response", "case": case, "order": 3});
    let refused = server.job(&third).await;
    refused.problem(422, "validation-failed");
    let told: Value = serde_json::from_slice(&refused.bytes).unwrap();
    assert_eq!(told["errors"][0]["pointer"], "/order");
    built(&server, json!({"kind": "response", "case": case})).await;
    let path = format!("/v1/cases/{case}/response?order=2");
    ask(server.get(&path).header("accept", OCTETS)).await.problem(404, "response-not-built");
    let applied = apply(&server, &case, &plan(), "application/json").await;
    let told = applied.expect(StatusCode::OK);
    assert_eq!((&told["order"], told.get("second_order_mm")), (&json!(1), None));
}

#[tokio::test]
async fn a_prediction_tells_what_linear_elasticity_leaves_out_or_why_that_is_not_known() {
    let server = Server::start();
    let case = case(&server).await;
    let spec = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan(), "outputs": ["skin.vtp"]});
    let job = built(&server, spec.clone()).await;
    let left = &job["results"]["nonlinearity_mm"];
    let [mean, p95, max] = ["mean", "p95", "max"].map(|name| left["skin"][name].as_f64().unwrap());
    assert!(0.0 < mean && mean < p95 && p95 <= max, "{left}");
    let path = format!("/v1/jobs/{}/results/skin.vtp", job["id"].as_str().unwrap());
    let skin = ask(server.get(&path)).await.bytes;
    assert!(skin.windows(22).any(|part| part == b"Name=\"nonlinearity_mm\""));

    let mut warped = spec;
    warped["method"] = json!("thickness_warp");
    let job = built(&server, warped).await;
    assert_eq!(job["results"]["nonlinearity_mm"], Value::Null);
    assert!(job["results"]["nonlinearity_unknown"].as_str().unwrap().contains("no linear finite"));
}
