//! Bodies and files under way: on the disk and not in the memory of the service, and no more of them than are allowed.

use reqwest::StatusCode;
use tempfile::TempDir;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use super::tenants::Hospital;
use crate::connections::{get, send};
use crate::helpers::{Block, SMALL, Server, ask};
use crate::processes::{resident, until};

const MIB: usize = 1 << 20;
const IN_FLIGHT: &str = "facies_http_body_bytes_in_flight";
const RESIDENT: &str = "process_resident_memory_bytes";

/// A request whose body does not come to its end.
async fn unfinished(hospital: &Hospital, key: &str, announced: usize) -> TcpStream {
    let head = format!(
        "POST /v1/meshes HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer {key}\r\n\
         Content-Type: model/stl\r\nContent-Length: {announced}\r\n\r\n"
    );
    let mut stream = send(&hospital.server, &head).await;
    stream.write_all(&vec![b'x'; announced - 1]).await.unwrap();
    stream
}

#[tokio::test]
async fn bodies_that_stand_still_take_no_memory() {
    const EACH: usize = 32 * MIB;
    let hospital = Hospital::open();
    let key = hospital.key("a", &["write"]).await;
    let process = hospital.server.process();
    let before = resident(process);
    let mut clients = Vec::new();
    for _ in 0..6 {
        clients.push(unfinished(&hospital, &key, EACH).await);
    }
    let grown = resident(process) - before;
    assert!(grown < EACH as f64, "{grown} bytes for {} of bodies", 6 * EACH);
    until("all that came is counted", async || {
        (hospital.metric(IN_FLIGHT).await == (6 * (EACH - 1)) as f64).then_some(())
    })
    .await;
    assert!(hospital.metric(RESIDENT).await > before / 2.0);
    drop(clients);
    until("their bytes are given back", async || {
        (hospital.metric(IN_FLIGHT).await == 0.0).then_some(())
    })
    .await;
    let left = std::fs::read_dir(hospital.server.path().join("tmp")).unwrap().count();
    assert_eq!(left, 0, "the files have no names");
}

#[tokio::test]
async fn readers_that_stand_still_take_no_memory() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["read", "write"]).await;
    let large = Block { cells: [90, 90, 60] };
    let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(&key);
    let upload = request.header("content-type", "application/octet-stream").body(large.vtu());
    let mesh = ask(upload).await.expect(StatusCode::CREATED);
    let path = format!("/v1/meshes/{}/content", mesh["id"].as_str().unwrap());
    let length = hospital.get(&key, &path).await.bytes.len();
    let head = get(&path).replace("\r\n\r\n", &format!("\r\nAuthorization: Bearer {key}\r\n\r\n"));
    let process = hospital.server.process();
    let before = resident(process);
    let mut readers = Vec::new();
    for _ in 0..16 {
        let reader = send(&hospital.server, &head).await;
        assert_eq!(reader.peek(&mut [0]).await.unwrap(), 1, "the answer has begun");
        readers.push(reader);
    }
    let grown = resident(process) - before;
    assert!(grown < 8.0 * length as f64, "{grown} bytes for 16 readers of {length}");
}

#[tokio::test]
async fn a_client_with_too_much_under_way_is_told_to_come_back_and_no_other() {
    let settings = ["--upload-mib", "2", "--client-bodies-mib", "2"];
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &settings);
    let (one, other) = (hospital.key("a", &["write"]).await, hospital.key("a", &["write"]).await);
    let upload = |key: &str| {
        let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(key);
        request.header("content-type", "application/octet-stream").body(SMALL.vtu())
    };
    let standing = unfinished(&hospital, &one, 2 * MIB).await;
    until("it has come", async || {
        (hospital.metric(IN_FLIGHT).await == (2 * MIB - 1) as f64).then_some(())
    })
    .await;
    let refused = ask(upload(&one)).await;
    assert_eq!(refused.problem(503, "busy")["limit"], 2 * MIB);
    assert!(!refused.header("retry-after").is_empty());
    ask(upload(&other)).await.expect(StatusCode::CREATED);
    drop(standing);
    until("it is let in again", async || {
        (ask(upload(&one)).await.status == StatusCode::OK).then_some(())
    })
    .await;
}

#[tokio::test]
async fn a_body_that_would_leave_too_little_space_is_refused() {
    let server = Server::start_with(&["--free-space-floor-mib", "1048576"]);
    let large = Block { cells: [44, 44, 30] };
    server.upload(large.vtu()).await.problem(507, "storage-full");
    // Sent piece by piece, it announces no length.
    let pieces = large.vtu().chunks(MIB).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let pieces = futures::stream::iter(pieces.into_iter().map(Ok::<_, std::io::Error>));
    server.upload(reqwest::Body::wrap_stream(pieces)).await.problem(507, "storage-full");
    server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn a_tenant_with_many_keys_leaves_a_share_to_others() {
    let settings = ["--upload-mib", "1", "--client-bodies-mib", "4", "--bodies-mib", "4"];
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &settings);
    let mut greedy = Vec::new();
    for _ in 0..4 {
        greedy.push(hospital.key("a", &["write"]).await);
    }
    let modest = hospital.key("b", &["write"]).await;
    let mut standing = Vec::new();
    for key in greedy.iter().take(3) {
        standing.push(unfinished(&hospital, key, MIB).await);
    }
    until("three of them have come", async || {
        (hospital.metric(IN_FLIGHT).await == (3 * (MIB - 1)) as f64).then_some(())
    })
    .await;
    let upload = |key: &str| {
        let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(key);
        request.header("content-type", "application/octet-stream").body(SMALL.vtu())
    };
    let refused = ask(upload(&greedy[3])).await;
    assert_eq!(refused.problem(503, "busy")["limit"], 3 * MIB);
    ask(upload(&modest)).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn what_is_announced_and_does_not_come_keeps_nobody_out() {
    let settings = ["--upload-mib", "1", "--client-bodies-mib", "4", "--bodies-mib", "4"];
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &settings);
    let key = hospital.key("a", &["write"]).await;
    let head = format!(
        "POST /v1/meshes HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer {key}\r\n\
         Content-Type: model/stl\r\nContent-Length: {MIB}\r\n\r\nsolid"
    );
    let mut standing = Vec::new();
    for _ in 0..8 {
        standing.push(send(&hospital.server, &head).await);
    }
    until("all have begun", async || {
        (hospital.metric(IN_FLIGHT).await == (8 * "solid".len()) as f64).then_some(())
    })
    .await;
    let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(&key);
    let upload = request.header("content-type", "application/octet-stream").body(SMALL.vtu());
    ask(upload).await.expect(StatusCode::CREATED);
}
