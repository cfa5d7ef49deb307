//! `If-Match` where something is erased, and query parameters that an operation does not have: neither is ignored.

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::helpers::{Block, SMALL, Server, ask, spec};

#[tokio::test]
async fn nothing_is_erased_in_another_version_than_the_one_that_is_named() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]});
    let plans = format!("/v1/cases/{case}/plans");
    let plan = ask(server.post(&plans).json(&plan)).await.expect(StatusCode::CREATED);
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let mesh = server.upload(Block { cells: [3, 3, 3] }.vtu()).await;
    let mesh = mesh.expect(StatusCode::CREATED);
    let id = |document: &Value| document["id"].as_str().unwrap().to_owned();
    for path in [
        format!("/v1/meshes/{}", id(&mesh)),
        format!("/v1/jobs/{}", id(&job)),
        format!("{plans}/{}", id(&plan)),
        format!("/v1/cases/{case}"),
    ] {
        let tag = ask(server.get(&path)).await.header("etag").to_owned();
        for wrong in ["\"9\"".to_owned(), format!("W/{tag}"), "\"a\", \"b\"".to_owned()] {
            let refused = ask(server.delete(&path).header("if-match", &wrong)).await;
            let problem = refused.problem_of(&path, 412, "precondition-failed");
            assert_eq!(problem["etag"], tag, "{path}");
        }
        ask(server.get(&path)).await.expect(StatusCode::OK);
        let erased = ask(server.delete(&path).header("if-match", tag)).await;
        assert_eq!(erased.status, StatusCode::NO_CONTENT, "{path}");
    }
}

#[tokio::test]
async fn a_job_and_a_mesh_are_erased_without_a_version_too() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let job = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await.json();
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let wrong = ask(server.delete(&path).header("if-match", "\"9\"")).await;
    wrong.problem(412, "precondition-failed");
    assert_eq!(ask(server.get(&path)).await.json()["status"], "accepted");
    assert_eq!(ask(server.delete(&path)).await.json()["status"], "dismissed");
    assert_eq!(ask(server.delete(&path)).await.status, StatusCode::NO_CONTENT);
    let mesh = server.upload(Block { cells: [3, 3, 3] }.vtu()).await.json();
    let path = format!("/v1/meshes/{}", mesh["id"].as_str().unwrap());
    assert_eq!(ask(server.delete(&path)).await.status, StatusCode::NO_CONTENT);
}

#[tokio::test]
async fn every_operation_refuses_a_parameter_that_it_does_not_have() {
    let server = Server::start();
    let document = facies::api::document();
    let id = uuid::Uuid::now_v7().to_string();
    let (mut asked, mut with_own) = (0, 0);
    for (route, item) in document["paths"].as_object().unwrap() {
        let path = route.replace("{id}", &id).replace("{plan}", &id).replace("{file}", "skin.vtp");
        for (method, operation) in item.as_object().unwrap() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let place = format!("{method} {route}");
            if !route.starts_with("/v1") {
                let answer = ask(server.request(method, &format!("{path}?dry_run=true"))).await;
                assert_ne!(answer.status, StatusCode::BAD_REQUEST, "{place}");
                continue;
            }
            for unknown in ["dry_run=true", "dry_run", "dry%5Frun=1&dry_run=2"] {
                let request = server.request(method.clone(), &format!("{path}?{unknown}"));
                let problem = ask(request).await.problem_of(&place, 400, "invalid-parameter");
                assert_eq!(problem["parameter"], "dry_run", "{place}");
            }
            asked += 1;
            let parameters = operation["parameters"].as_array().into_iter().flatten();
            for own in parameters.filter(|parameter| parameter["in"] == "query") {
                let name = own["name"].as_str().unwrap();
                let request = server.request(method.clone(), &format!("{path}?{name}="));
                let detail = String::from_utf8(ask(request).await.bytes).unwrap();
                assert!(!detail.contains("unknown parameter"), "{place} {name}: {detail}");
                with_own += 1;
            }
        }
    }
    assert!(asked >= 35 && with_own >= 15, "{asked} operations, {with_own} parameters");
    let head = ask(server.request(Method::HEAD, "/v1/jobs?dry_run=true")).await;
    assert_eq!(head.status, StatusCode::BAD_REQUEST);
}
