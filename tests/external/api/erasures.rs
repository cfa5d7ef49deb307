//! What is erased while somebody downloads it or a job needs it.

use facies::schema::wire::canonical::sha256_hex;
use reqwest::StatusCode;
use tempfile::TempDir;
use tokio::io::AsyncReadExt;
use tokio::net::TcpStream;

use crate::connections::{get, send};
use crate::deployments::Deployment;
use crate::helpers::{Block, SMALL, Server, ask, serve_shared};
use crate::invariants::{accepted, succeeds, tagged, works_on};
use crate::processes::{faulty, signal, stopped_slot};
use crate::support::trials::trials;

trials! {
    on_shared {
        what_is_kept_too_long_is_erased_under_a_download_and_not_under_a_job
        a_job_that_is_posted_again_with_its_key_is_not_too_old
    }
    alone {
        a_case_is_erased_under_a_job_and_under_a_download_that_ends_whole
    }
}

/// More than the buffers of a connection take.
const LARGE: Block = Block { cells: [44, 44, 30] };
const FAULT: &str = "solve:begin:1:stop:tag=slow";

/// A download that has begun, and the hash that it has to have.
struct Download {
    stream: TcpStream,
    length: usize,
    sha256: String,
}

impl Download {
    /// Of the mesh of a case.
    async fn begun(server: &Server, case: &str) -> Download {
        let case = ask(server.get(&format!("/v1/cases/{case}"))).await.expect(StatusCode::OK);
        let path = format!("/v1/meshes/{}/content", case["case"]["volume"].as_str().unwrap());
        let whole = ask(server.get(&path)).await.bytes;
        let stream = send(server, &get(&path)).await;
        assert_eq!(stream.peek(&mut [0]).await.unwrap(), 1, "the answer has begun");
        Download { stream, length: whole.len(), sha256: sha256_hex(&whole) }
    }

    async fn ends_whole(mut self) {
        let mut bytes = Vec::new();
        while !bytes.windows(4).any(|end| end == b"\r\n\r\n") {
            bytes.push(self.stream.read_u8().await.unwrap());
        }
        let mut body = vec![0; self.length];
        self.stream.read_exact(&mut body).await.unwrap();
        assert_eq!(sha256_hex(&body), self.sha256);
    }
}

async fn a_case_is_erased_under_a_job_and_under_a_download_that_ends_whole() {
    let server = faulty(FAULT, &["--workers", "1"]);
    let solved = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&solved, 1.0, "slow")).await;
    let slot = stopped_slot(server.process()).await;
    let downloaded = server.case(&LARGE).await;
    let download = Download::begun(&server, &downloaded).await;
    for case in [solved, downloaded] {
        let erase = server.delete(&format!("/v1/cases/{case}")).header("if-match", "*");
        assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    }
    download.ends_whole().await;
    signal(slot, "CONT");
    for path in ["", "/results", "/results/skin.vtp"] {
        ask(server.get(&format!("/v1/jobs/{id}{path}"))).await.problem(410, "gone");
    }
    works_on(&server).await;
    assert!(!server.path().join("tmp").join(&id).exists());
    let (folder, _) = server.terminate();
    let mut fsck = std::process::Command::new(env!("CARGO_BIN_EXE_facies"));
    let found = fsck.args(["admin", "fsck", "--read-all", "--data"]).arg(folder.path()).output();
    assert!(found.unwrap().status.success(), "nothing is left over");
}

async fn what_is_kept_too_long_is_erased_under_a_download_and_not_under_a_job(on: Deployment) {
    let mut command = serve_shared(&on);
    command.args(["--workers", "1"]).env("FACIES_FAULT", FAULT);
    let server = Server::start_command(command, TempDir::new().unwrap());
    let old = server.case(&LARGE).await;
    let used = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&used, 1.0, "slow")).await;
    let slot = stopped_slot(server.process()).await;
    let download = Download::begun(&server, &old).await;
    // As the process of another host does it.
    let store = on.open().await;
    store.retain(Some(1)).await.unwrap();
    on.execute("UPDATE cases SET updated = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 1);
    download.ends_whole().await;
    ask(server.get(&format!("/v1/cases/{old}"))).await.problem(410, "gone");
    signal(slot, "CONT");
    succeeds(&server, &id, 1).await;
}

async fn a_job_that_is_posted_again_with_its_key_is_not_too_old(on: Deployment) {
    let server = Server::start_command(serve_shared(&on), TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    let post = async || {
        let request = server.post("/v1/jobs").header("idempotency-key", "k");
        let request = request.header("prefer", "wait=30").json(&tagged(&case, 1.0, "a"));
        ask(request).await.expect(StatusCode::OK)
    };
    let job = post().await;
    let store = on.open().await;
    store.retain(Some(1)).await.unwrap();
    on.execute("UPDATE jobs SET updated = 1").await;
    assert_eq!(post().await["id"], job["id"]);
    assert_eq!(store.erase_old().await.unwrap(), 0);
    on.execute("UPDATE jobs SET updated = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 1);
}
