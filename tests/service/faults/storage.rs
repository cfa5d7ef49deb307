//! Things that break under the service: nothing accepted is lost, nothing half done is left.

use std::process::Command;

use reqwest::StatusCode;
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use crate::helpers::{Block, SMALL, Server, ask, serve, spec};

/// Solved in seconds, so that a test can meet its job at work.
const LARGE: Block = Block { cells: [44, 44, 30] };

async fn accepted(server: &Server, spec: &Value) -> String {
    let job = ask(server.post("/v1/jobs").json(spec)).await.expect(StatusCode::CREATED);
    job["id"].as_str().unwrap().to_owned()
}

#[tokio::test]
async fn a_killed_server_loses_no_job_and_finishes_it_once() {
    let server = Server::start();
    let case = server.case(&LARGE).await;
    let id = accepted(&server, &spec(&case, 2.0)).await;
    assert_eq!(server.started(&id).await["status"], "running");
    let folder = server.kill();
    let temporary = || std::fs::read_dir(folder.path().join("tmp")).unwrap().count();
    assert_eq!(temporary(), 1, "the attempt was at work");

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
    let left = std::fs::read_dir(server.path().join("tmp")).unwrap().count();
    assert_eq!(left, 0, "the files of the first attempt are gone");
}

#[tokio::test]
async fn a_dismissed_job_frees_its_worker() {
    let server = Server::start_with(&["--workers", "1"]);
    let large = server.case(&LARGE).await;
    let small = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&large, 2.0)).await;
    assert_eq!(server.started(&id).await["status"], "running");
    let dismissed = ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    assert_eq!(dismissed["status"], "dismissed");
    let next = server.job(&spec(&small, 1.0)).await.expect(StatusCode::OK);
    assert_eq!(next["status"], "successful");
    let state = ask(server.get(&format!("/v1/jobs/{id}"))).await.json();
    assert_eq!(state["status"], "dismissed");
    let late = server.path().join("tmp").join(&id);
    assert!(!late.exists(), "the files of the dismissed job are gone");
}

#[tokio::test]
async fn a_job_over_its_budget_of_time_fails_and_says_so() {
    let server = Server::start_with(&["--workers", "1"]);
    let case = server.case(&LARGE).await;
    let mut hurried = spec(&case, 2.0);
    hurried["budget"] = json!({"wall_s": 0.001});
    let id = accepted(&server, &hurried).await;
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("failed"), &json!(1)));
    assert_eq!(job["error"]["type"], "budget-exceeded");
    let results = ask(server.get(&format!("/v1/jobs/{id}/results"))).await;
    assert_eq!(results.problem(422, "job-failed")["error"]["type"], "budget-exceeded");
}

#[tokio::test]
async fn a_server_told_to_stop_gives_its_job_to_the_next() {
    let server = Server::start_with(&["--grace-s", "0"]);
    let case = server.case(&LARGE).await;
    let id = accepted(&server, &spec(&case, 2.0)).await;
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
        "POST /v1/meshes HTTP/1.1\r\nHost: x\r\nContent-Type: model/stl\r\nContent-Length: {}\r\n\r\n",
        bytes.len()
    );
    let mut connection = TcpStream::connect(server.host()).await.unwrap();
    connection.write_all(head.as_bytes()).await.unwrap();
    connection.write_all(&bytes[..bytes.len() / 2]).await.unwrap();
    drop(connection);
    let folder = server.kill();
    let server = Server::start_in(folder, &[]);
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap().count();
    let temporary = std::fs::read_dir(server.path().join("tmp")).unwrap().count();
    assert_eq!((blobs, temporary), (0, 0));
    server.upload(bytes).await.expect(StatusCode::CREATED);
}

/// A disk of a few MiB, where this user may mount one.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount() -> Option<SmallDisk> {
        let folder = TempDir::new().unwrap();
        let options = ["-t", "tmpfs", "-o", "size=6m", "tmpfs"];
        let mounted = Command::new("mount").args(options).arg(folder.path()).output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Some(SmallDisk(folder));
        }
        crate::shared::say_skipped("a small disk can be mounted by root only");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // A failure leaves an empty mount behind, which no other test meets.
        let _ = Command::new("umount").arg("--lazy").arg(self.0.path()).status();
    }
}

#[tokio::test]
async fn a_full_disk_refuses_uploads_fails_jobs_and_serves_what_is_there() {
    let Some(disk) = SmallDisk::mount() else { return };
    let data = disk.0.path().join("data");
    let server = Server::start_command(serve(&data), TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    let kept = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let kept = format!("/v1/jobs/{}", kept["id"].as_str().unwrap());

    // Leaves room for a row and not for a mesh or a result.
    let filler = disk.0.path().join("filler");
    let free = || {
        let disk = rustix::fs::statvfs(disk.0.path()).unwrap();
        (disk.f_bavail * disk.f_frsize) as usize
    };
    std::fs::write(&filler, vec![0; free().saturating_sub(100 << 10)]).unwrap();
    let large = Block { cells: [40, 40, 10] };
    let answer = server.upload(large.vtu()).await;
    answer.problem(507, "storage-full");
    let blobs = |folder: &str| std::fs::read_dir(data.join(folder)).unwrap().count();
    let before = blobs("blobs");
    ask(server.get(&format!("{kept}/results/skin.vtp"))).await;
    assert_eq!(ask(server.get(&kept)).await.expect(StatusCode::OK)["status"], "successful");
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);

    std::fs::remove_file(&filler).unwrap();
    assert_eq!(blobs("blobs"), before);
    let again = server.upload(Block { cells: [6, 6, 6] }.vtu()).await;
    again.expect(StatusCode::CREATED);
}
