//! A batch: the report of a study over predictions that are listed one by one.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask, spec};

fn item(case: &str, x: f64, method: &str) -> Value {
    let mut item = spec(case, x);
    item["method"] = method.into();
    item
}

#[tokio::test]
async fn a_batch_has_a_row_for_each_of_its_items_and_no_other() {
    let server = Server::start();
    let (one, other) = (server.case(&SMALL).await, server.case(&SMALL).await);
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [2, 0, 0]}]});
    let plans = format!("/v1/cases/{one}/plans");
    let plan = ask(server.post(&plans).json(&plan)).await.expect(StatusCode::CREATED);
    let mut stored =
        json!({"case": one, "plan_id": plan["id"], "method": "fem_linear", "element": "plain"});
    stored["label"] = "plain".into();
    let mut soft = item(&one, 1.0, "fem_linear");
    soft["materials"] = json!({"*": {"young_modulus_kpa": 5, "poisson_ratio": 0.3}});
    let batch = json!({
        "kind": "batch", "repeats": 1, "truth": {"refine": 1, "element": "mean_dilatation"},
        "items": [item(&one, 1.0, "fem_linear"), item(&one, 1.0, "thickness_warp"), stored, soft,
            item(&other, 3.0, "fem_linear")],
    });
    let job = server.job(&batch).await.expect(StatusCode::OK);
    assert_eq!((&job["kind"], &job["status"]), (&json!("batch"), &json!("successful")));
    let path = format!("/v1/jobs/{}/report?format=json", job["id"].as_str().unwrap());
    let report = ask(server.get(&path)).await.expect(StatusCode::OK);
    let rows = report["rows"].as_array().unwrap();
    let mut told: Vec<(&str, &str)> = rows
        .iter()
        .map(|row| (row["scene"].as_str().unwrap(), row["label"].as_str().unwrap()))
        .collect();
    told.sort_unstable();
    let wanted = [
        ("case 1", "fem_linear"),
        ("case 1", "thickness_warp"),
        ("case 3", "plain"),
        ("case 4", "fem_linear"),
        ("case 5", "fem_linear"),
    ];
    assert_eq!(told, wanted);
    let moved = |scene: &str| {
        let row = rows.iter().find(|row| row["scene"] == scene && row["label"] != "thickness_warp");
        row.unwrap()["skin_mean_mm"].as_f64().unwrap()
    };
    assert!((moved("case 5") / moved("case 1") - 3.0).abs() < 1e-6, "each has its own plan");
    assert_ne!(moved("case 4"), moved("case 1"), "each has its own materials");
}

#[tokio::test]
async fn what_is_wrong_with_an_item_is_reported_with_its_place() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let good = item(&case, 1.0, "fem_linear");
    let with = |name: &str, value: Value| {
        let mut item = good.clone();
        item[name] = value;
        item
    };
    for (items, pointer, code) in [
        (json!([]), "/items", "missing-field"),
        (json!([good, good]), "/items/1", "duplicate-name"),
        (json!([with("case", "nobody".into())]), "/items/0/case", "unknown-case"),
        (json!([with("tags", json!(["a"]))]), "/items/0/tags", "unknown-field"),
        (json!([with("accept_mm", 0.1.into())]), "/items/0/accept_mm", "method-mismatch"),
        (json!([good, with("corrected", true.into())]), "/items/1/corrected", "unknown-field"),
        (json!([with("estimate", "all".into())]), "/items/0/estimate", "unknown-word"),
        (json!([with("range_mm", 5.into())]), "/items/0/range_mm", "unknown-field"),
        (json!([with("elment", "plain".into())]), "/items/0/elment", "unknown-field"),
        (json!([with("method", "magic".into())]), "/items/0/method", "unknown-word"),
        (
            json!([
                good,
                with("element", "plain".into()),
                with("label", "fem_linear plain".into())
            ]),
            "/items/2/label",
            "duplicate-name",
        ),
        (json!([{"case": case, "plan_id": case}]), "/items/0/plan_id", "unknown-plan"),
        (
            json!([with(
                "plan",
                json!({"segments": [{"name": "no", "translation_mm": [1, 0, 0]}]})
            )]),
            "/items/0/plan/segments/0/name",
            "unknown-segment",
        ),
    ] {
        let answer =
            ask(server.post("/v1/jobs").json(&json!({"kind": "batch", "items": items}))).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{pointer}: {answer:?}");
        let problem = answer.json();
        let errors = problem["errors"].as_array().unwrap();
        let told = |error: &Value| error["pointer"] == pointer && error["code"] == code;
        assert!(errors.iter().any(told), "{pointer}: {errors:?}");
    }
    let mixed = json!({"kind": "batch", "items": [good], "scenes": ["slab"]});
    let problem = ask(server.post("/v1/jobs").json(&mixed)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/scenes");
    let mixed = json!({"kind": "study", "items": [good], "scenes": ["slab"]});
    let problem = ask(server.post("/v1/jobs").json(&mixed)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/items");
}
