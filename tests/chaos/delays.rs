//! Processes that stand still: longer than a lease, longer than a request to stop, longer than a budget.

use std::path::Path;
use std::time::Duration;

use reqwest::StatusCode;
use serde_json::json;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{Connection as _, Row as _};
use tokio::task::JoinHandle;

use crate::helpers::{SMALL, Server, ask, spec};
use crate::invariants::{accepted, fails, files, state, succeeds, tagged, undisturbed, works_on};
use crate::processes::{faulty, faulty_with_log, is_gone, is_stopped, signal, slots, until};

/// A server whose worker stands still before it publishes, its job, and its database. `None` where it stood still in the
/// middle of another write, which lets nobody else write.
async fn stands_still(log: &Path) -> Option<(Server, Posting, SqliteConnection)> {
    let fault = "publish:before:1:stop:attempt=1";
    let server = faulty_with_log(fault, &["--workers", "1"], log);
    let case = server.case(&SMALL).await;
    // The answer to the request may not come any more.
    let posting = tokio::spawn(server.post("/v1/jobs").json(&spec(&case, 1.0)).send());
    until("the worker stops itself", async || is_stopped(server.process()).then_some(())).await;
    let file = server.path().join("facies.db");
    let options = SqliteConnectOptions::new().filename(file).busy_timeout(Duration::ZERO);
    let mut database = SqliteConnection::connect_with(&options).await.unwrap();
    let write = sqlx::query("UPDATE jobs SET losses = losses").execute(&mut database).await;
    write.is_ok().then_some((server, posting, database))
}

type Posting = JoinHandle<reqwest::Result<reqwest::Response>>;

/// What another worker does with a job whose lease has run out; the data folder of SQLite serves one process, so that
/// the test takes its part.
const TAKE: &str = "UPDATE jobs SET losses = losses + 1, lease_token = NULL, lease_expires = NULL, \
     status = 'accepted' WHERE status = 'running' AND lease_expires < (SELECT now_ms FROM clock)";

#[tokio::test]
async fn a_worker_that_stood_still_for_longer_than_its_lease_publishes_nothing() {
    let folder = tempfile::TempDir::new().unwrap();
    let log = folder.path().join("log");
    let (server, posting, mut database) = loop {
        if let Some(found) = stands_still(&log).await {
            break found;
        }
    };
    until("the lease runs out", async || {
        let taken = sqlx::query(TAKE).execute(&mut database).await.unwrap();
        (taken.rows_affected() == 1).then_some(())
    })
    .await;
    let row = sqlx::query("SELECT id, result FROM jobs").fetch_one(&mut database).await.unwrap();
    let (id, result): (String, Option<String>) = (row.get(0), row.get(1));
    assert_eq!(result, None);

    signal(server.process(), "CONT");
    posting.await.unwrap().unwrap();
    let job = succeeds(&server, &id, 2).await;
    assert_eq!(files(&job), undisturbed(&SMALL, 1.0).await);
    until("the first attempt is told apart", async || {
        std::fs::read_to_string(&log).unwrap().contains("\"status\":\"fenced\"").then_some(())
    })
    .await;
}

#[tokio::test]
async fn a_job_dismissed_while_it_cannot_be_interrupted_frees_its_slot() {
    let server = faulty("solve:begin:1:hang:tag=deaf", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&case, 1.0, "deaf")).await;
    until("the job factorises", async || {
        (state(&server, &id).await["phase"] == "solve").then_some(())
    })
    .await;
    let before = slots(&server);
    let dismissed = ask(server.delete(&format!("/v1/jobs/{id}"))).await.json();
    assert_eq!(dismissed["status"], "dismissed");
    // The only slot is free again once its process has been killed.
    works_on(&server).await;
    assert!(before.iter().all(|process| is_gone(*process)));
    assert_eq!(state(&server, &id).await["status"], "dismissed");
    assert!(!server.path().join("tmp").join(&id).exists());
}

#[tokio::test]
async fn a_slot_that_stands_still_fails_its_job_over_its_budget() {
    let server = faulty("solve:begin:1:stop:tag=still", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let mut hurried = tagged(&case, 1.0, "still");
    hurried["budget"] = json!({"wall_s": 0.2});
    let id = accepted(&server, &hurried).await;
    let error = fails(&server, &id, 1).await;
    assert_eq!((&error["type"], &error["which"]), (&"budget-exceeded".into(), &"wall".into()));
    assert_eq!(error["allowed_s"], 0.2);
    works_on(&server).await;
}

#[tokio::test]
async fn slots_that_were_stopped_while_they_were_idle_cost_no_attempt_and_hold_up_nothing() {
    let server = Server::start_with(&["--workers", "3"]);
    works_on(&server).await;
    let case = server.case(&SMALL).await;
    let idle: [u32; 3] = slots(&server).try_into().unwrap();
    idle.into_iter().for_each(|slot| signal(slot, "STOP"));
    let all_stand_still = async || idle.into_iter().all(is_stopped).then_some(());
    until("the slots stand still", all_stand_still).await;
    let given = accepted(&server, &spec(&case, 1.0)).await;
    let behind = accepted(&server, &spec(&case, 2.0)).await;
    let job = succeeds(&server, &given, 1).await;
    assert_eq!(files(&job), undisturbed(&SMALL, 1.0).await);
    succeeds(&server, &behind, 1).await;
}

#[tokio::test]
async fn a_slot_that_is_never_ready_is_killed_and_begun_again() {
    let folder = tempfile::TempDir::new().unwrap();
    let log = folder.path().join("log");
    let server = faulty_with_log("slot:start:1:hang", &["--workers", "1"], &log);
    let first = until("a slot begins", async || slots(&server).first().copied()).await;
    until("another begins", async || {
        slots(&server).first().filter(|slot| **slot != first).copied()
    })
    .await;
    assert!(is_gone(first));
    let text = std::fs::read_to_string(&log).unwrap();
    assert!(text.contains("did not start") && text.contains("not ready after 10 s"), "{text}");
}

#[tokio::test]
async fn a_job_dismissed_while_its_publication_hangs_frees_its_slot() {
    let server = faulty("publish:before:1:hang:tag=deaf", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&case, 1.0, "deaf")).await;
    server.started(&id).await;
    ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    works_on(&server).await;
    assert_eq!(state(&server, &id).await["status"], "dismissed");
}

#[tokio::test]
async fn a_publication_that_hangs_beyond_the_time_of_its_job_is_an_attempt_lost() {
    let server = faulty("publish:before:1:hang:attempt=1:tag=still", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let mut hurried = tagged(&case, 1.0, "still");
    hurried["budget"] = json!({"wall_s": 3.0});
    let id = accepted(&server, &hurried).await;
    succeeds(&server, &id, 2).await;
}
