//! Clients that stand still, or leave, in the middle of a request or of an answer.

use std::time::Duration;

use reqwest::StatusCode;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::connections::{get, send};
use crate::helpers::{Block, SMALL, Server, ask};
use crate::invariants::{accepted, succeeds, tagged, works_on};
use crate::processes::{descriptors, faulty, faulty_in, signal, stopped_slot, until};

/// Some megabytes.
const LARGE: Block = Block { cells: [44, 44, 30] };

/// A mesh that a server of usual patience has stored: one without much would give up an upload from a busy machine.
struct Uploaded {
    folder: TempDir,
    path: String,
    /// Of its content.
    length: usize,
}

async fn uploaded() -> Uploaded {
    let server = Server::start();
    let mesh = server.upload(LARGE.vtu()).await.expect(StatusCode::CREATED);
    let path = format!("/v1/meshes/{}/content", mesh["id"].as_str().unwrap());
    let length = ask(server.get(&path)).await.bytes.len();
    let (folder, _) = server.terminate();
    Uploaded { folder, path, length }
}

fn sockets(server: &Server) -> usize {
    let files = descriptors(server.process());
    files.iter().filter(|file| file.starts_with("socket:")).count()
}

#[tokio::test]
async fn clients_that_stop_reading_are_given_up_and_hold_up_nobody() {
    let Uploaded { folder, path, length } = uploaded().await;
    let server = faulty_in(folder, "solve:begin:1:hang:tag=deaf", &["--body-idle-s", "1"]);
    let nobody = sockets(&server);
    let case = server.case(&SMALL).await;
    let job = accepted(&server, &tagged(&case, 1.0, "deaf")).await;
    // More than there are connections to the database, and each asks for more than any buffer takes.
    let mut stalled = Vec::new();
    for _ in 0..8 {
        stalled.push(send(&server, &get(&path).repeat(8)).await);
    }
    let mut following = Vec::new();
    for _ in 0..4 {
        following.push(send(&server, &get(&format!("/v1/jobs/{job}/events"))).await);
    }
    for stream in stalled.iter().chain(&following) {
        assert_eq!(stream.peek(&mut [0]).await.unwrap(), 1, "the answer has begun");
    }
    works_on(&server).await;
    ask(server.delete(&format!("/v1/jobs/{job}"))).await.expect(StatusCode::OK);
    until("all are given up", async || (sockets(&server) == nobody).then_some(())).await;
    for mut stream in stalled {
        // That it was given up is told by an error, or by the end of an answer before its length.
        let mut taken = Vec::new();
        let _ = stream.read_to_end(&mut taken).await;
        assert!(taken.len() < 8 * length);
    }
}

#[tokio::test]
async fn a_client_that_never_ends_its_head_is_given_up() {
    let server = Server::start_with(&["--body-idle-s", "0.5"]);
    let head = "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Slow: ";
    for sent in ["", head] {
        let mut stream = send(&server, sent).await;
        assert_eq!(stream.read(&mut [0]).await.unwrap(), 0, "74 {sent}");
    }
    let mut stream = send(&server, head).await;
    until("74 one byte after the other is not enough", async || stream.write_all(b"x").await.err())
        .await;
}

/// A byte of the body after the other goes out until the server answers with 408.
async fn times_out_while_trickling(what: &str, mut stream: TcpStream) {
    let answer = until(what, async || {
        // Who has answered may have gone.
        let _ = stream.write_all(b"x").await;
        let mut answer = vec![0; 4096];
        let count = stream.try_read(&mut answer).ok()?;
        Some(String::from_utf8_lossy(&answer[..count]).into_owned())
    })
    .await;
    assert!(answer.starts_with("HTTP/1.1 408"), "{answer}");
}

#[tokio::test]
async fn a_body_that_comes_byte_by_byte_is_given_up() {
    let server = Server::start_with(&["--body-idle-s", "0.5"]);
    let head = "POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/stl\r\nContent-Length: 999999\r\n\r\n";
    let stream = send(&server, head).await;
    times_out_while_trickling("74 byte by byte", stream).await;
}

#[tokio::test]
async fn what_came_at_once_is_no_excuse_for_a_body_that_trickles() {
    let server = Server::start_with(&["--body-idle-s", "0.5"]);
    let head = "POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/stl\r\nContent-Length: 33554432\r\n\r\n";
    let mut stream = send(&server, head).await;
    // At the least rate this is worth half an hour.
    stream.write_all(&vec![b'x'; 32_000_000]).await.unwrap();
    times_out_while_trickling("after 32 MB at once", stream).await;
}

#[tokio::test]
async fn an_answer_that_is_taken_too_slowly_is_broken_off() {
    let Uploaded { folder, path, .. } = uploaded().await;
    let server = Server::start_in(folder, &["--body-idle-s", "0.5"]);
    let path = format!("{path}?format=stl");
    let nobody = sockets(&server);
    let stream = send(&server, &get(&path).repeat(8)).await;
    until("it is closed although something is taken all the time", async || {
        // Some 10 KiB a second: the window of the connection moves, but not fast enough.
        let _ = stream.try_read(&mut [0; 64]);
        stream.ready(tokio::io::Interest::READABLE).await.ok()?;
        (sockets(&server) <= nobody).then_some(())
    })
    .await;
}

#[tokio::test]
async fn the_listener_for_administration_has_no_more_patience() {
    let mut server = Server::start_with(&["--body-idle-s", "0.5", "--admin-bind", "127.0.0.1:0"]);
    let line = server.second_line();
    let admin_address =
        line.strip_prefix("metrics on http://").unwrap().trim_end_matches("/metrics");
    let head = "PUT /tenants/a HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n";
    for sent in ["", "GET /heal", &format!("{head}Content-Length: 99\r\n\r\n{{")] {
        let mut stream = TcpStream::connect(admin_address).await.unwrap();
        stream.write_all(sent.as_bytes()).await.unwrap();
        let mut taken = Vec::new();
        let closed = tokio::time::timeout(Duration::from_secs(30), stream.read_to_end(&mut taken));
        let closed = closed.await;
        assert!(closed.is_ok(), "{sent:?} is kept");
    }
}

#[tokio::test]
async fn a_client_that_leaves_while_it_waits_leaves_its_job_at_work() {
    let server = faulty("solve:begin:1:stop:tag=slow", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let before = sockets(&server);
    let spec = tagged(&case, 1.0, "slow").to_string();
    let length = spec.len();
    let head = "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nPrefer: wait=30";
    let stream = send(&server, &format!("{head}\r\nContent-Length: {length}\r\n\r\n{spec}")).await;
    let slot = stopped_slot(server.process()).await;
    drop(stream);
    until("the service has noticed", async || (sockets(&server) <= before).then_some(())).await;
    signal(slot, "CONT");
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    succeeds(&server, jobs["items"][0]["id"].as_str().unwrap(), 1).await;
}
