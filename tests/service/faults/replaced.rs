//! The files of an embedded database are replaced, removed or cut while it is served.

use std::path::Path;

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{SMALL, Server, ask, serve, spec};
use crate::invariants::{accepted, is_shed, tagged, works_on};
use crate::processes::{faulty_with_log, signal, stopped_slot, until};

fn in_use() -> Server {
    Server::start_with(&["--workers", "1", "--admin-bind", "127.0.0.1:0"])
}

/// What is read and written is refused, and operators are told.
async fn is_given_up(server: &mut Server, case: &str) {
    for _ in 0..3 {
        assert!(is_shed(&ask(server.post("/v1/jobs").json(&spec(case, 2.0))).await));
        assert!(is_shed(&ask(server.get("/v1/cases")).await));
        let ready = ask(server.get("/readyz")).await.problem(503, "not-ready");
        let checks = ready["checks"].as_array().unwrap();
        assert!(checks.contains(&"database".into()), "{ready}");
        assert!(!checks.contains(&"storage".into()), "{ready}");
    }
    let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
    let counted = String::from_utf8(ask(server.client.get(&metrics)).await.bytes).unwrap();
    assert!(counted.lines().any(|line| line == "facies_database_up 0"), "{counted}");
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);
}

#[tokio::test]
async fn nothing_is_acknowledged_beside_a_file_that_took_the_place_of_the_database() {
    let mut server = in_use();
    let case = server.case(&SMALL).await;
    let file = server.path().join("facies.db");
    let copy = server.path().join("copy");
    std::fs::copy(&file, &copy).unwrap();
    let own = server.path().join("own");
    std::fs::rename(&file, &own).unwrap();
    std::fs::rename(copy, &file).unwrap();
    is_given_up(&mut server, &case).await;
    let ready = ask(server.get("/readyz")).await.problem(503, "not-ready");
    assert!(ready["detail"].as_str().unwrap().contains("restart the service"), "{ready}");
    // Nor when it is back: others may have changed its log meanwhile.
    std::fs::rename(own, &file).unwrap();
    assert!(is_shed(&ask(server.get("/v1/cases")).await));
    let server = Server::start_in(server.kill(), &["--workers", "1"]);
    works_on(&server).await;
}

#[tokio::test]
async fn nothing_is_acknowledged_once_the_files_of_the_database_are_removed() {
    let mut server = in_use();
    let case = server.case(&SMALL).await;
    for name in ["facies.db", "facies.db-wal", "facies.db-shm"] {
        std::fs::remove_file(server.path().join(name)).unwrap();
    }
    is_given_up(&mut server, &case).await;
    assert!(!server.path().join("facies.db").exists(), "it is not made again");
}

#[tokio::test]
async fn nothing_is_acknowledged_once_another_process_may_hold_the_lock_of_the_folder() {
    let mut server = in_use();
    let case = server.case(&SMALL).await;
    let lock = server.path().join("lock");
    std::fs::remove_file(&lock).unwrap();
    std::fs::File::create(&lock).unwrap().try_lock().unwrap();
    is_given_up(&mut server, &case).await;
    let ready = ask(server.get("/readyz")).await.problem(503, "not-ready");
    assert!(ready["detail"].as_str().unwrap().contains("the file `lock`"), "{ready}");
    let server = Server::start_in(server.kill(), &["--workers", "1"]);
    works_on(&server).await;
}

#[tokio::test]
async fn no_job_is_claimed_from_a_database_that_was_removed() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let fault = "solve:begin:1:stop:attempt=1:tag=slow";
    let server = faulty_with_log(fault, &["--workers", "1"], &log);
    let case = server.case(&SMALL).await;
    accepted(&server, &tagged(&case, 1.0, "slow")).await;
    let slot = stopped_slot(server.process()).await;
    accepted(&server, &spec(&case, 2.0)).await;
    std::fs::remove_file(server.path().join("facies.db")).unwrap();
    signal(slot, "CONT");
    let told = until("the worker finds no job", async || {
        let told = std::fs::read_to_string(&log).unwrap();
        told.contains("no job could be claimed").then_some(told)
    })
    .await;
    assert!(told.contains("restart the service"), "{told}");
    assert_eq!(told.matches("job started").count(), 1, "{told}");
}

fn cut(file: &Path) {
    std::fs::File::create(file).unwrap();
}

#[tokio::test]
async fn a_log_that_was_emptied_is_noticed_by_the_probes_alone() {
    let mut server = in_use();
    let case = server.case(&SMALL).await;
    let file = server.path().join("facies.db");
    let before = std::fs::read(&file).unwrap();
    cut(&server.path().join("facies.db-wal"));
    until("the service says that it is not ready", async || {
        (ask(server.get("/readyz")).await.status != StatusCode::OK).then_some(())
    })
    .await;
    is_given_up(&mut server, &case).await;
    until("the database is given up as damaged", async || {
        let ready = ask(server.get("/readyz")).await.problem(503, "not-ready");
        ready["detail"].as_str().unwrap().contains("is damaged").then_some(())
    })
    .await;
    // A clean end leaves the file as it is: with the log that was lost its rows are whole.
    let (folder, ended) = server.terminate();
    assert!(ended && std::fs::read(folder.path().join("facies.db")).unwrap() == before);
}

#[test]
fn a_start_on_a_damaged_database_exits_with_1() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("facies.db");
    std::fs::write(&file, [7; 8192]).unwrap();
    let output = serve(folder.path()).stderr(std::process::Stdio::piped()).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("facies.db is damaged"), "{told}");
}
