//! Requests that are sent again because their answer got lost.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

const KEY: &str = "idempotency-key";

async fn post(server: &Server, path: &str, key: &str, body: &Value) -> Answer {
    ask(server.post(path).header(KEY, key).json(body)).await
}

#[tokio::test]
async fn a_case_that_is_sent_again_with_its_key_is_the_same_case() {
    let server = Server::start();
    let send = |key: &'static str, name: &str| {
        let mut case = SMALL.case();
        case["name"] = name.into();
        let request = server.post("/v1/cases").header(KEY, key).multipart(SMALL.form(&case));
        async { ask(request).await }
    };
    let first = send("a", "one").await;
    let id = first.expect(StatusCode::CREATED)["id"].clone();
    // The form is packed anew with another boundary; its content is the same.
    let again = send("a", "one").await;
    assert_eq!(again.expect(StatusCode::CREATED)["id"], id);
    assert_eq!(again.header("location"), first.header("location"));
    send("a", "two").await.problem(422, "idempotency-mismatch");
    assert_ne!(send("b", "one").await.expect(StatusCode::CREATED)["id"], id);
    let erase = server.delete(first.header("location")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    send("a", "one").await.problem(410, "gone");
}

#[tokio::test]
async fn a_request_that_was_refused_makes_what_it_says_when_it_is_sent_again() {
    let server = Server::start();
    let mesh = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let path = format!("/v1/meshes/{}", mesh["id"].as_str().unwrap());
    let mut case = SMALL.case();
    case["volume"] = mesh["id"].clone();
    ask(server.delete(&path)).await;
    post(&server, "/v1/cases", "k", &case).await.problem(422, "validation-failed");
    post(&server, "/v1/cases", "k", &case).await.problem(422, "validation-failed");
}

#[tokio::test]
async fn requests_with_one_key_that_come_together_make_one_thing() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]});
    let path = format!("/v1/cases/{case}/plans");
    let together = (0..50).map(|_| post(&server, &path, "p", &plan));
    let mut ids: Vec<Value> = futures::future::join_all(together)
        .await
        .iter()
        .map(|answer| answer.expect(StatusCode::CREATED)["id"].clone())
        .collect();
    ids.dedup();
    assert_eq!(ids.len(), 1, "{ids:?}");
    let kept = ask(server.get(&path)).await.json();
    assert_eq!(kept["items"].as_array().unwrap().len(), 1);
    // The case is part of the request; another route has keys of its own.
    let other = server.case(&SMALL).await;
    let elsewhere = format!("/v1/cases/{other}/plans");
    post(&server, &elsewhere, "p", &plan).await.problem(422, "idempotency-mismatch");
    assert_eq!(ask(server.get(&elsewhere)).await.json()["items"], json!([]));
    post(&server, "/v1/jobs", "p", &spec(&case, 1.0)).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn two_keys_in_one_request_are_refused() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    for second in ["one", "two"] {
        let request = server.post("/v1/jobs").header(KEY, "one").header(KEY, second);
        let refused = ask(request.json(&spec(&case, 1.0))).await;
        let problem = refused.problem(400, "invalid-parameter");
        assert_eq!(problem["parameter"], "Idempotency-Key");
    }
    assert_eq!(ask(server.get("/v1/jobs")).await.json()["items"], json!([]));
}

#[tokio::test]
async fn a_job_that_is_sent_again_with_its_key_is_no_duplicate() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let first = post(&server, "/v1/jobs", "j", &spec(&case, 1.0)).await;
    let job = first.expect(StatusCode::CREATED);
    server.ended(job["id"].as_str().unwrap()).await;
    let again = post(&server, "/v1/jobs", "j", &spec(&case, 1.0)).await.expect(StatusCode::OK);
    assert_eq!((&again["id"], &again["deduplicated"]), (&job["id"], &json!(false)));
    let other = post(&server, "/v1/jobs", "other", &spec(&case, 1.0)).await.expect(StatusCode::OK);
    assert_eq!((&other["id"], &other["deduplicated"]), (&job["id"], &json!(true)));
    post(&server, "/v1/jobs", "j", &spec(&case, 2.0)).await.problem(422, "idempotency-mismatch");
    for wrong in ["", &"x".repeat(256)] {
        let refused = post(&server, "/v1/jobs", wrong, &spec(&case, 1.0)).await;
        assert_eq!(refused.problem(400, "invalid-parameter")["parameter"], "Idempotency-Key");
    }
}

#[tokio::test]
async fn a_key_that_was_told_of_a_known_job_is_told_of_it_again_and_makes_no_other() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    for _ in 0..2 {
        let told = post(&server, "/v1/jobs", "k", &spec(&case, 1.0)).await.expect(StatusCode::OK);
        assert_eq!((&told["id"], &told["deduplicated"]), (&job["id"], &json!(true)));
    }
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    assert_eq!(ask(server.delete(&path)).await.status, StatusCode::NO_CONTENT);
    post(&server, "/v1/jobs", "k", &spec(&case, 1.0)).await.problem(410, "gone");
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(jobs["items"], json!([]));
}
