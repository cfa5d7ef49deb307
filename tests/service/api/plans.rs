//! Plans that are kept with their case.

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask};

fn plan(x: f64) -> Value {
    json!({"segments": [{"name": "bone", "translation_mm": [x, 0.0, 0.0]}]})
}

#[tokio::test]
async fn a_plan_is_kept_changed_by_version_and_carried_out_as_it_was() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plans = format!("/v1/cases/{case}/plans");
    let kept = ask(server.post(&plans).json(&plan(1.0))).await;
    let view = kept.expect(StatusCode::CREATED);
    let id = view["id"].as_str().unwrap();
    let path = format!("{plans}/{id}");
    assert_eq!(kept.header("location"), path);
    assert_eq!((view["plan"].clone(), kept.header("etag")), (plan(1.0), "\"1\""));

    let spec = json!({"kind": "predict", "case": case, "plan_id": id});
    let first = server.job(&spec).await.expect(StatusCode::OK);

    let put = |tag: Option<&str>| {
        let request = server.request(Method::PUT, &path).json(&plan(2.0));
        ask(match tag {
            Some(tag) => request.header("if-match", tag),
            None => request,
        })
    };
    assert_eq!(put(None).await.problem(428, "precondition-required")["etag"], "\"1\"");
    put(Some("\"7\"")).await.problem(412, "precondition-failed");
    put(Some("W/\"1\"")).await.problem(412, "precondition-failed");
    let changed = put(Some("\"0\", \"1\"")).await;
    assert_eq!(changed.expect(StatusCode::OK)["plan"], plan(2.0));
    assert_eq!(changed.header("etag"), "\"2\"");
    put(Some("\"1\"")).await.problem(412, "precondition-failed");

    let second = server.job(&spec).await.expect(StatusCode::OK);
    assert_ne!(first["spec_hash"], second["spec_hash"]);
    let listed = ask(server.get(&plans)).await.expect(StatusCode::OK);
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    let known = ask(server.get(&path).header("if-none-match", "\"2\"")).await;
    assert_eq!(known.status, StatusCode::NOT_MODIFIED);

    ask(server.delete(&path)).await.problem(428, "precondition-required");
    let deleted = ask(server.delete(&path).header("if-match", "*")).await;
    assert_eq!(deleted.status, StatusCode::NO_CONTENT);
    ask(server.get(&path)).await.problem(410, "gone");
    let gone = ask(server.post("/v1/jobs").json(&spec)).await;
    assert_eq!(gone.problem(422, "validation-failed")["errors"][0]["pointer"], "/plan_id");
}

#[tokio::test]
async fn a_plan_of_a_case_that_is_not_there_is_not_kept() {
    let server = Server::start();
    let nobody = uuid::Uuid::now_v7();
    let plans = format!("/v1/cases/{nobody}/plans");
    ask(server.post(&plans).json(&plan(1.0))).await.problem(404, "not-found");
    ask(server.get(&plans)).await.problem(404, "not-found");
}

#[tokio::test]
async fn a_name_tells_a_plan_from_others_and_changes_nothing_of_what_is_computed() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plans = format!("/v1/cases/{case}/plans");
    let named = |name: &str| {
        let mut plan = plan(1.0);
        plan["name"] = name.into();
        plan
    };
    let keep = |name: &str| ask(server.post(&plans).json(&named(name)));
    let first = keep("bone forward").await.expect(StatusCode::CREATED);
    let second = keep("the same").await.expect(StatusCode::CREATED);
    let listed = ask(server.get(&plans)).await.expect(StatusCode::OK);
    let names: Vec<&Value> =
        listed["items"].as_array().unwrap().iter().map(|item| &item["plan"]["name"]).collect();
    assert_eq!(names, ["the same", "bone forward"]);

    let job = |id: &Value| json!({"kind": "predict", "case": case, "plan_id": id});
    let jobs = [job(&first["id"]), job(&second["id"])];
    let hash =
        async |spec: &Value| server.job(spec).await.expect(StatusCode::OK)["spec_hash"].clone();
    assert_eq!(hash(&jobs[0]).await, hash(&jobs[1]).await);

    let long = "a".repeat(129);
    for name in ["", " ", "a\nb", &long] {
        let refused = keep(name).await;
        let fault = &refused.problem(422, "validation-failed")["errors"][0];
        assert_eq!(
            (fault["code"].as_str(), fault["pointer"].as_str()),
            (Some("bad-name"), Some("/name")),
            "{name:?}"
        );
    }
}
