//! Turns of tenants at what takes a processor for long.

use reqwest::{RequestBuilder, StatusCode};
use serde_json::json;
use tempfile::TempDir;

use super::tenants::Hospital;
use crate::helpers::{Answer, Block, SMALL, ask};
use crate::processes::until;

/// It takes a while to be read.
const LARGE: Block = Block { cells: [44, 44, 30] };
const UPLOADS: usize = 12;
const WAITING: &str = "facies_http_requests_waiting{for=\"parse\"}";

fn upload(hospital: &Hospital, key: &str, bytes: Vec<u8>) -> RequestBuilder {
    let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(key);
    request.header("content-type", "application/octet-stream").body(bytes)
}

/// As many uploads at once as a greedy client would send, none equal to another.
fn flood(hospital: &Hospital, key: &str) -> Vec<tokio::task::JoinHandle<Answer>> {
    let bytes = LARGE.vtu();
    let different = (0..UPLOADS).map(|number| [&bytes[..], &vec![b'\n'; number]].concat());
    different.map(|bytes| tokio::spawn(ask(upload(hospital, key, bytes)))).collect()
}

#[tokio::test]
async fn uploads_of_one_tenant_hold_up_neither_the_jobs_nor_the_uploads_of_another() {
    let hospital = Hospital::open();
    let all = ["read", "write", "run"];
    let (greedy, modest) = (hospital.key("a", &all).await, hospital.key("b", &all).await);
    let form = hospital.server.post("/v1/cases").bearer_auth(&modest);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    let flood = flood(&hospital, &greedy);
    until("they wait", async || {
        (hospital.metric(WAITING).await > UPLOADS as f64 / 2.0).then_some(())
    })
    .await;
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]});
    let job = json!({"kind": "predict", "case": case["id"], "plan": plan});
    hospital.post(&modest, "/v1/jobs", &job).await.expect(StatusCode::CREATED);
    let small = upload(&hospital, &modest, [&SMALL.vtu()[..], b"\n"].concat());
    ask(small).await.expect(StatusCode::CREATED);
    assert!(hospital.metric(WAITING).await > 0.0, "others still wait");
    for answer in flood {
        answer.await.unwrap().expect(StatusCode::CREATED);
    }
}

#[tokio::test]
async fn who_waits_too_many_times_is_told_to_come_back() {
    let settings = ["--waiting-requests", "1"];
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &settings);
    let key = hospital.key("a", &["read", "write"]).await;
    let limits = hospital.get(&key, "/v1/limits").await.expect(StatusCode::OK);
    assert_eq!(limits["waiting_requests"], 1);
    let mut refused = 0;
    for answer in flood(&hospital, &key) {
        let answer = answer.await.unwrap();
        if answer.status != StatusCode::CREATED {
            assert_eq!(answer.problem(503, "busy")["limit"], 1);
            assert!(!answer.header("retry-after").is_empty());
            refused += 1;
        }
    }
    assert!((1..UPLOADS).contains(&refused), "{refused} are refused");
}
