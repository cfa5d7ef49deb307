//! Requests that arrive in the wrong moment, and storage that errs in one.

use reqwest::StatusCode;

use crate::helpers::{SMALL, Server, ask, spec};
use crate::invariants::{accepted, files, shows_no_result, state, succeeds, undisturbed, works_on};
use crate::processes::{faulty, until};

#[tokio::test]
async fn a_job_dismissed_before_it_is_claimed_is_never_started() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&case, 1.0)).await;
    ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    let (folder, _) = server.terminate();
    let server = Server::start_in(folder, &["--workers", "1"]);
    works_on(&server).await;
    let job = state(&server, &id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&"dismissed".into(), &0.into()));
}

#[tokio::test]
async fn a_job_dismissed_while_it_is_published_never_becomes_successful() {
    let server = faulty("publish:before:1:hold", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&case, 1.0)).await;
    until("the files are written", async || {
        (state(&server, &id).await["phase"] == "write").then_some(())
    })
    .await;
    shows_no_result(&server, &id).await;
    ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    let folder = server.path().join("tmp").join(&id);
    until("the attempt ends", async || (!folder.exists()).then_some(())).await;
    assert_eq!(state(&server, &id).await["status"], "dismissed");
    let (folder, ended) = server.terminate();
    assert!(ended);
    let server = Server::start_in(folder, &["--workers", "0"]);
    assert_eq!(state(&server, &id).await["status"], "dismissed");
}

#[tokio::test]
async fn a_publication_that_errs_once_is_tried_again() {
    let server = faulty("publish:before:1:error:attempt=1", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&case, 1.0)).await;
    let job = succeeds(&server, &id, 2).await;
    assert_eq!(files(&job), undisturbed(&SMALL, 1.0).await);
}
