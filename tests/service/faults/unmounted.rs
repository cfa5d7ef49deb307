//! A store of blobs that goes away or never answers: 503 meanwhile, nothing lost, nothing stored elsewhere.

use std::net::TcpListener;
use std::sync::mpsc::channel;
use std::time::Duration;

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{Answer, Block, SMALL, Server, ask, serve, spec};
use crate::invariants::{accepted, succeeds};

fn is_out_of_reach(answer: &Answer, what: &str) {
    answer.problem_of(what, 503, "not-ready");
    assert!(!answer.header("retry-after").is_empty(), "{what}");
}

#[tokio::test]
async fn a_folder_of_blobs_that_is_not_mounted_takes_nothing_and_loses_nothing() {
    let disk = TempDir::new().unwrap();
    let (blobs, away) = (disk.path().join("blobs"), disk.path().join("away"));
    let server = Server::start_with(&["--workers", "1", "--blobs", blobs.to_str().unwrap()]);
    let case = server.case(&SMALL).await;
    let done = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let file = format!("/v1/jobs/{}/results/skin.vtp", done["id"].as_str().unwrap());
    let other = Block { cells: [3, 3, 3] };

    std::fs::rename(&blobs, &away).unwrap();
    // The mount point.
    std::fs::create_dir(&blobs).unwrap();
    is_out_of_reach(&ask(server.get("/readyz")).await, "readiness");
    is_out_of_reach(&ask(server.get(&file)).await, "a file");
    is_out_of_reach(&server.upload(other.vtu()).await, "an upload");
    let waiting = accepted(&server, &spec(&case, 2.0)).await;
    assert_eq!(std::fs::read_dir(&blobs).unwrap().count(), 0);

    std::fs::remove_dir(&blobs).unwrap();
    std::fs::rename(&away, &blobs).unwrap();
    ask(server.get("/readyz")).await.expect(StatusCode::OK);
    assert_eq!(ask(server.get(&file)).await.status, StatusCode::OK);
    server.upload(other.vtu()).await.expect(StatusCode::CREATED);
    succeeds(&server, &waiting, 1).await;
}

#[tokio::test]
async fn an_embedded_database_whose_folder_of_blobs_is_empty_at_the_start_does_not_serve() {
    let disk = TempDir::new().unwrap();
    let blobs = disk.path().join("blobs");
    let arguments = ["--workers", "0", "--blobs", blobs.to_str().unwrap()];
    let server = Server::start_with(&arguments);
    server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let (folder, _) = server.terminate();
    std::fs::rename(&blobs, disk.path().join("away")).unwrap();
    let output = serve(folder.path()).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(78), "{output:?}");
    assert!(!blobs.join("facies-owner").exists());
}

#[tokio::test]
async fn a_store_that_accepts_and_never_answers_does_not_keep_the_service_from_starting() {
    // The system accepts, and nobody reads.
    let deaf = TcpListener::bind("127.0.0.1:0").unwrap();
    let folder = TempDir::new().unwrap();
    let mut command = serve(folder.path());
    command
        .args(["--workers", "0", "--blobs", "s3://faces/ward"])
        .env("AWS_ENDPOINT_URL", format!("http://{}", deaf.local_addr().unwrap()))
        .env("AWS_ALLOW_HTTP", "true")
        .env("AWS_REGION", "us-east-1")
        .env("AWS_ACCESS_KEY_ID", "key")
        .env("AWS_SECRET_ACCESS_KEY", "secret");
    let (told, started) = channel();
    std::thread::spawn(move || {
        let _ = told.send(Server::start_command(command, folder));
    });
    let server = started.recv_timeout(Duration::from_secs(60)).expect("it listens");
    is_out_of_reach(&ask(server.get("/readyz")).await, "readiness");
    ask(server.get("/healthz")).await.expect(StatusCode::OK);
    ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
}
