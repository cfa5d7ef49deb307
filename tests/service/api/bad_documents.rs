//! Plans and specs that are wrong on purpose, through HTTP.
//! The first word of a name is the row of the list of bad inputs that it stands for.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask, spec};

/// Name, what is put into a spec, the code of the problem, the pointer of its first mistake.
type Row = (&'static str, Value, &'static str, &'static str);

fn moved(movement: Value) -> Value {
    let mut segment = json!({"name": "bone"});
    segment.as_object_mut().unwrap().extend(movement.as_object().unwrap().clone());
    json!({"plan": {"segments": [segment]}})
}

fn matrix(change: impl Fn(&mut [f64; 16])) -> Value {
    let mut entries = [0.0; 16];
    for diagonal in [0, 5, 10, 15] {
        entries[diagonal] = 1.0;
    }
    change(&mut entries);
    moved(json!({"matrix4x4": entries}))
}

fn plans() -> Vec<Row> {
    let at = "/plan/segments/0";
    let twice = json!([{"name": "bone", "translation_mm": [1, 0, 0]}, {"name": "bone", "translation_mm": [1, 0, 0]}]);
    let turned = |deg: f64| {
        moved(
            json!({"rotation_deg": [deg, 0, 0], "pivot_mm": [0, 0, 0], "translation_mm": [0, 0, 0]}),
        )
    };
    let far = |mm: f64| moved(json!({"translation_mm": [mm, 0, 0]}));
    vec![
        ("50 scale", matrix(|m| m[0] = 1.1), "plan-not-rigid", at),
        ("50 shear", matrix(|m| m[1] = 0.2), "plan-not-rigid", at),
        ("50 reflection", matrix(|m| m[0] = -1.0), "plan-not-rigid", at),
        ("51 500 mm", far(500.0), "plan-out-of-range", at),
        ("51 1e308 mm", far(1e308), "plan-out-of-range", at),
        ("51 400 deg", turned(400.0), "plan-out-of-range", at),
        ("52 null", moved(json!({"translation_mm": [null, 0, 0]})), "validation-failed", at),
        ("52 text", moved(json!({"translation_mm": ["3", 0, 0]})), "validation-failed", at),
        ("53 misspelt", moved(json!({"translation": [1, 0, 0]})), "validation-failed", at),
        (
            "55 unknown segment",
            json!({"plan": {"segments": [{"name": "nose", "translation_mm": [1, 0, 0]}]}}),
            "unknown-segment",
            at,
        ),
        ("55 twice", json!({"plan": {"segments": twice}}), "validation-failed", "/plan/segments"),
        (
            "60 activation",
            json!({"plan": {"muscle_activation": {"masseter_l": 1.5}}}),
            "validation-failed",
            "/plan/muscle_activation",
        ),
    ]
}

fn specs() -> Vec<Row> {
    let tissue = |material: Value| json!({"materials": {"tissue": material}});
    let at = "/materials/tissue";
    vec![
        ("58 nu 0.5", tissue(json!({"poisson_ratio": 0.5})), "validation-failed", at),
        ("58 nu -1", tissue(json!({"poisson_ratio": -1})), "validation-failed", at),
        ("58 E 0", tissue(json!({"young_modulus_kpa": 0})), "validation-failed", at),
        ("58 E 1e20", tissue(json!({"young_modulus_kpa": 1e20})), "validation-failed", at),
        ("58 density", tissue(json!({"density_g_per_cm3": -1})), "validation-failed", at),
        (
            "59 unknown region",
            json!({"materials": {"bark": {"young_modulus_kpa": 1}}}),
            "validation-failed",
            "/materials/bark",
        ),
        (
            "61 tolerance 0",
            json!({"tolerance": {"relative_residual": 0}}),
            "validation-failed",
            "/tolerance/relative_residual",
        ),
        (
            "61 tolerance 1e-300",
            json!({"tolerance": {"relative_residual": 1e-300}}),
            "validation-failed",
            "/tolerance/relative_residual",
        ),
        ("61 budget 0", json!({"budget": {"wall_s": 0}}), "validation-failed", "/budget/wall_s"),
        ("61 steps", json!({"steps": 1e9}), "validation-failed", "/steps"),
        ("62 path", json!({"outputs": ["../../x"]}), "validation-failed", "/outputs/0"),
        ("62 unknown format", json!({"outputs": ["skin.obj"]}), "validation-failed", "/outputs/0"),
        (
            "63 nobody's mesh",
            json!({"compare_to": {"actual": {"mesh": uuid::Uuid::now_v7()}}}),
            "validation-failed",
            "/compare_to/actual/mesh",
        ),
        ("case", json!({"case": "../../etc"}), "validation-failed", "/case"),
        ("plan id", json!({"plan": null}), "validation-failed", "/plan"),
    ]
}

#[tokio::test]
async fn every_bad_plan_and_spec_is_refused_with_its_place() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    for (name, change, code, pointer) in plans().into_iter().chain(specs()) {
        let mut spec = spec(&case, 1.0);
        spec.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        let answer = ask(server.post("/v1/jobs").json(&spec)).await;
        let problem = answer.problem_of(name, 422, code);
        let first = problem["errors"][0]["pointer"].as_str().unwrap_or_default();
        assert!(first.starts_with(pointer), "{name}: {problem}");
    }
    let listed = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"], json!([]), "nothing was accepted");
}

#[tokio::test]
async fn what_is_not_json_is_refused_with_its_place() {
    let server = Server::start_with(&["--workers", "0"]);
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let large = format!("{{\"kind\": \"{}\"}}", "x".repeat(1 << 20));
    let utf16: Vec<u8> = "{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (name, body, status, code) in [
        ("52 NaN", b"{\"kind\": NaN}".to_vec(), 400, "malformed-json"),
        ("52 1e999", b"{\"kind\": 1e999}".to_vec(), 400, "malformed-json"),
        (
            "54 twice",
            b"{\"kind\": \"predict\", \"kind\": \"predict\"}".to_vec(),
            422,
            "validation-failed",
        ),
        ("75 deep", deep.into_bytes(), 400, "malformed-json"),
        ("75 large", large.into_bytes(), 413, "payload-too-large"),
        ("75 utf-16", utf16, 400, "malformed-json"),
        ("75 utf-8", b"{\"kind\": \"\xff\"}".to_vec(), 400, "malformed-json"),
        ("75 mark", b"\xef\xbb\xbf{}".to_vec(), 422, "validation-failed"),
        ("75 surrogate", b"{\"kind\": \"\\ud800\"}".to_vec(), 400, "malformed-json"),
        ("nothing", vec![], 400, "malformed-json"),
        ("an array", b"[]".to_vec(), 422, "validation-failed"),
    ] {
        for path in ["/v1/jobs", "/v1/cases"] {
            let request = server.post(path).header("content-type", "application/json");
            let answer = ask(request.body(body.clone())).await;
            let problem = answer.problem_of(&format!("{name} {path}"), status, code);
            if code == "malformed-json" {
                assert!(problem["line"].is_u64() && problem["column"].is_u64(), "{problem}");
            }
        }
    }
}

#[tokio::test]
async fn a_kind_that_does_not_exist_is_reported() {
    let server = Server::start_with(&["--workers", "0"]);
    let answer = ask(server.post("/v1/jobs").json(&json!({"kind": "guess"}))).await;
    assert_eq!(answer.problem(422, "validation-failed")["errors"][0]["pointer"], "/kind");
}

#[tokio::test]
async fn a_comparison_is_refused_where_its_surfaces_are_not_there() {
    let server = Server::start_with(&["--workers", "0"]);
    let mesh = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let case = server.case(&SMALL).await;
    let waiting =
        ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await.expect(StatusCode::CREATED);
    let nobody = uuid::Uuid::now_v7();
    let compare = |prediction: Value, actual: Value| json!({"kind": "compare", "prediction": prediction, "actual": {"mesh": actual}});
    for (spec, pointer) in [
        (compare(json!({"mesh": mesh["id"]}), json!(nobody)), "/actual/mesh"),
        (compare(json!({"mesh": nobody}), mesh["id"].clone()), "/prediction/mesh"),
        (compare(json!({"job": nobody}), mesh["id"].clone()), "/prediction/job"),
        (compare(json!({"job": waiting["id"]}), mesh["id"].clone()), "/prediction/job"),
        (compare(json!({}), mesh["id"].clone()), "/prediction"),
    ] {
        let answer = ask(server.post("/v1/jobs").json(&spec)).await;
        let problem = answer.problem_of(pointer, 422, "validation-failed");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    }
}
