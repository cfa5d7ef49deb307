//! Things that break under the service: nothing accepted is lost, nothing half done is left.

use std::path::{Path, PathBuf};

use reqwest::StatusCode;
use serde_json::json;
use tempfile::TempDir;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use crate::helpers::{SMALL, Server, ask, spec};
use crate::invariants::{MEDIUM, accepted, state, succeeds, tagged};
use crate::processes::{faulty, faulty_with_log, until};

/// Keeps a job at work until it is told to stop, so that a test meets it there.
const HELD: &str = "solve:iteration:3:hold:attempt=1:tag=slow";

/// Files under way.
fn temporary(folder: &Path) -> usize {
    std::fs::read_dir(folder.join("tmp")).unwrap().count()
}

#[tokio::test]
async fn a_killed_server_loses_no_job_and_finishes_it_once() {
    let server = faulty(HELD, &[]);
    let case = server.case(&MEDIUM).await;
    let id = accepted(&server, &tagged(&case, 2.0, "slow")).await;
    until("the attempt is at work", async || (temporary(server.path()) == 1).then_some(())).await;
    let folder = server.kill();
    assert_eq!(temporary(folder.path()), 1, "the attempt was at work");

    let server = Server::start_in(folder, &[]);
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("successful"), &json!(2)));
    let jobs = ask(server.get("/v1/jobs")).await.json();
    assert_eq!(jobs["items"].as_array().unwrap().len(), 1);
    for file in job["results"]["files"].as_array().unwrap() {
        let name = file["name"].as_str().unwrap();
        let answer = ask(server.get(&format!("/v1/jobs/{id}/results/{name}"))).await;
        assert_eq!(
            facies::schema::wire::canonical::sha256_hex(&answer.bytes),
            file["sha256"].as_str().unwrap()
        );
    }
    assert_eq!(temporary(server.path()), 0, "the files of the first attempt are gone");
}

#[tokio::test]
async fn a_dismissed_job_frees_its_worker() {
    for held in [HELD, "publish:before:1:hold:attempt=1:tag=slow"] {
        let folder = TempDir::new().unwrap();
        let log = folder.path().join("log");
        let server = faulty_with_log(held, &["--workers", "1"], &log);
        let large = server.case(&MEDIUM).await;
        let small = server.case(&SMALL).await;
        let id = accepted(&server, &tagged(&large, 2.0, "slow")).await;
        assert_eq!(server.started(&id).await["status"], "running");
        let dismissed = ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
        assert_eq!(dismissed["status"], "dismissed");
        let next = server.job(&spec(&small, 1.0)).await.expect(StatusCode::OK);
        assert_eq!(next["status"], "successful");
        let state = ask(server.get(&format!("/v1/jobs/{id}"))).await.json();
        assert_eq!(state["status"], "dismissed");
        let late = server.path().join("tmp").join(&id);
        assert!(!late.exists(), "the files of the dismissed job are gone");
        let told = std::fs::read_to_string(&log).unwrap();
        let ended: Vec<&str> = told.lines().filter(|line| line.contains("job ended")).collect();
        assert!(ended[0].contains("\"status\":\"dismissed\""), "{ended:?}");
    }
}

#[tokio::test]
async fn a_job_over_its_budget_of_time_fails_and_says_so() {
    let server = Server::start_with(&["--workers", "1"]);
    let case = server.case(&MEDIUM).await;
    let mut hurried = spec(&case, 2.0);
    hurried["budget"] = json!({"wall_s": 0.001});
    let id = accepted(&server, &hurried).await;
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("failed"), &json!(1)));
    assert_eq!(job["error"]["type"], "budget-exceeded");
    let results = ask(server.get(&format!("/v1/jobs/{id}/results"))).await;
    assert_eq!(results.problem(422, "job-failed")["error"]["type"], "budget-exceeded");
    let anew = accepted(&server, &hurried).await;
    assert_ne!(anew, id, "another time it may be quicker");
}

#[tokio::test]
async fn a_server_that_stops_gives_its_job_to_the_next() {
    let server = faulty(HELD, &["--grace-s", "0"]);
    let case = server.case(&MEDIUM).await;
    let id = accepted(&server, &tagged(&case, 2.0, "slow")).await;
    assert_eq!(server.started(&id).await["status"], "running");
    let (folder, ended) = server.terminate();
    assert!(ended);
    let server = Server::start_in(folder, &["--workers", "0"]);
    let job = ask(server.get(&format!("/v1/jobs/{id}"))).await.json();
    assert_eq!((&job["status"], &job["attempt"]), (&json!("accepted"), &json!(1)));
}

#[tokio::test]
async fn an_upload_that_breaks_off_leaves_nothing() {
    let server = Server::start();
    let bytes = SMALL.vtu();
    let head = format!(
        "POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/stl\r\nContent-Length: {}\r\n\r\n",
        bytes.len()
    );
    let mut connection = TcpStream::connect(server.host()).await.unwrap();
    connection.write_all(head.as_bytes()).await.unwrap();
    connection.write_all(&bytes[..bytes.len() / 2]).await.unwrap();
    drop(connection);
    let folder = server.kill();
    let server = Server::start_in(folder, &[]);
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap().count();
    assert_eq!((blobs, temporary(server.path())), (0, 0));
    server.upload(bytes).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn no_job_is_claimed_while_there_is_no_space_for_its_result() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let full = ["--workers", "1", "--free-space-floor-mib", "1048576"];
    let server = faulty_with_log("", &full, &log);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&case, 1.0)).await;
    until("the worker tells it", async || {
        let text = std::fs::read_to_string(&log).unwrap();
        text.contains("no job is claimed while the storage fails").then_some(())
    })
    .await;
    let job = state(&server, &id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("accepted"), &json!(0)));
    let server = Server::start_in(server.kill(), &["--workers", "1"]);
    succeeds(&server, &id, 1).await;
}

/// The files with stored bytes.
fn blobs(folder: &Path) -> Vec<PathBuf> {
    let within =
        |folder: &Path| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let folders = within(&folder.join("blobs")).filter(|path| path.is_dir());
    folders.flat_map(|folder| within(&folder).collect::<Vec<_>>()).collect()
}

#[tokio::test]
async fn lost_and_damaged_meshes_are_stored_again_when_they_are_uploaded_again() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let server = faulty_with_log("", &["--workers", "0", "--mesh-cache-mib", "0"], &log);
    let upload = async || server.upload(SMALL.vtu()).await;
    let mesh = upload().await.expect(StatusCode::CREATED);
    let id = mesh["id"].as_str().unwrap();
    let content = format!("/v1/meshes/{id}/content");
    let right = ask(server.get(&content)).await;
    assert_eq!(right.status, StatusCode::OK);

    let [blob] = blobs(server.path()).try_into().unwrap();
    std::fs::remove_file(&blob).unwrap();
    names(&ask(server.get(&content)).await.problem(500, "integrity"), &format!("mesh {id}"));
    names(
        &ask(server.get(&format!("{content}?format=stl"))).await.problem(500, "integrity"),
        &format!("mesh {id}"),
    );
    assert_eq!(upload().await.expect(StatusCode::OK)["id"], id);
    assert_eq!(ask(server.get(&content)).await.bytes, right.bytes);

    // A case that brings the file heals it as well.
    let case = ask(server.post("/v1/cases").multipart(SMALL.form(&SMALL.case()))).await;
    let case = case.expect(StatusCode::CREATED)["case"]["volume"].clone();
    let content = format!("/v1/meshes/{}/content", case.as_str().unwrap());
    for path in blobs(server.path()) {
        std::fs::write(path, "cut").unwrap();
    }
    ask(server.get(&content)).await.problem(500, "integrity");
    let again = ask(server.post("/v1/cases").multipart(SMALL.form(&SMALL.case()))).await;
    assert_eq!(again.expect(StatusCode::CREATED)["case"]["volume"], case);
    assert_eq!(ask(server.get(&content)).await.status, StatusCode::OK);

    assert!(server.terminate().1);
    let told = std::fs::read_to_string(&log).unwrap();
    let told = told.lines().filter(|line| line.contains("stored again from an upload"));
    let told: Vec<&str> = told.filter(|line| line.contains("WARN")).collect();
    assert!(told.len() == 2 && told[0].contains(id), "{told:?}");
}

/// The detail of a problem begins with what is damaged.
fn names(problem: &serde_json::Value, what: &str) {
    assert!(problem["detail"].as_str().unwrap().starts_with(&format!("{what}: ")), "{problem}");
}

#[tokio::test]
async fn a_file_of_a_result_that_is_lost_is_named() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let id = job["id"].as_str().unwrap();
    blobs(server.path()).iter().for_each(|blob| std::fs::remove_file(blob).unwrap());
    let lost = ask(server.get(&format!("/v1/jobs/{id}/results/skin.vtp"))).await;
    names(&lost.problem(500, "integrity"), &format!("skin.vtp of job {id}"));
}

#[tokio::test]
async fn a_job_whose_mesh_is_lost_or_damaged_names_it_and_says_which() {
    for (what, why) in [(None, "missing"), (Some("cut"), "damaged")] {
        let server = Server::start_with(&["--workers", "0"]);
        let form = server.post("/v1/cases").multipart(SMALL.form(&SMALL.case()));
        let case = ask(form).await.expect(StatusCode::CREATED);
        let job = accepted(&server, &spec(case["id"].as_str().unwrap(), 1.0)).await;
        let folder = server.kill();
        for path in blobs(folder.path()) {
            match what {
                None => std::fs::remove_file(path).unwrap(),
                Some(bytes) => std::fs::write(path, bytes).unwrap(),
            }
        }
        let server = Server::start_in(folder, &["--workers", "1", "--attempts", "1"]);
        let error = server.ended(&job).await["error"].clone();
        let (kind, class) = (&error["type"], &error["class"]);
        assert_eq!((kind, class), (&json!("storage"), &json!("infrastructure")), "{error}");
        let (detail, mesh) = (error["detail"].as_str().unwrap(), case["case"]["volume"].as_str());
        assert!(detail.contains(mesh.unwrap()) && detail.contains(why), "{detail}");
        assert_eq!(error["attempts"], 1, "{error}");
    }
}
