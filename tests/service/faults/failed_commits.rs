//! Commits of the embedded database that the disk does not take.

use reqwest::StatusCode;
use rustix::process::{Pid, Resource, Rlimit, prlimit};
use serde_json::json;

use crate::helpers::{SMALL, Server, ask, spec};
use crate::invariants::{accepted, is_shed, succeeds, works_on};
use crate::processes::until;

/// Lets no file of a server grow, or any: a write is refused as on a disk that is full for a moment.
fn lets_files_grow(server: &Server, grow: bool) {
    let process = Pid::from_raw(i32::try_from(server.process()).unwrap());
    let current = (!grow).then_some(1);
    prlimit(process, Resource::Fsize, Rlimit { current, maximum: None }).unwrap();
}

#[tokio::test]
async fn a_commit_that_failed_is_told_while_it_fails_and_ends_no_writing() {
    let server = Server::start_with(&["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let plans = format!("/v1/cases/{case}/plans");
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]});
    let done = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let done = format!("/v1/jobs/{}", done["id"].as_str().unwrap());
    for _ in 0..2 {
        lets_files_grow(&server, false);
        until("the service says that it is not ready", async || {
            let ready = ask(server.get("/readyz")).await.json();
            ready["checks"].as_array()?.contains(&json!("database")).then_some(())
        })
        .await;
        for _ in 0..3 {
            assert!(is_shed(&ask(server.post(&plans).json(&plan)).await));
            assert!(is_shed(&ask(server.post("/v1/jobs").json(&spec(&case, 2.0))).await));
            assert!(is_shed(&ask(server.delete(&done)).await));
        }
        assert_eq!(ask(server.get(&done)).await.expect(StatusCode::OK)["status"], "successful");
        lets_files_grow(&server, true);
        until("the service is ready", async || {
            (ask(server.get("/readyz")).await.status == StatusCode::OK).then_some(())
        })
        .await;
        ask(server.post(&plans).json(&plan)).await.expect(StatusCode::CREATED);
    }
    let job = accepted(&server, &spec(&case, 3.0)).await;
    succeeds(&server, &job, 1).await;
    assert_eq!(ask(server.delete(&done)).await.status, StatusCode::NO_CONTENT);
    works_on(&server).await;
}
