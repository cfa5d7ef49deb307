//! Files over HTTP where their bytes are on another machine.

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::connections::{get, send};
use crate::deployments::Deployment;
use crate::helpers::{Block, Server, ask, serve_shared};
use crate::support::trials::trials;

trials! {
    on_shared {
        a_part_of_a_file_is_a_part_of_the_whole_and_a_damaged_one_is_not_sent
    }
}

async fn a_part_of_a_file_is_a_part_of_the_whole_and_a_damaged_one_is_not_sent(on: Deployment) {
    let mut command = serve_shared(&on);
    command.args(["--workers", "0"]);
    let server = Server::start_command(command, TempDir::new().unwrap());
    let large = Block { cells: [44, 44, 30] };
    let mesh = server.upload(large.vtu()).await.expect(StatusCode::CREATED);
    let path = format!("/v1/meshes/{}/content", mesh["id"].as_str().unwrap());
    let whole = ask(server.get(&path)).await;
    let (tag, length) = (whole.header("etag"), whole.bytes.len());
    assert_eq!(whole.header("content-length"), length.to_string());
    let range = format!("bytes={}-{}", length / 2, length - 2);
    let part = ask(server.get(&path).header("range", &range).header("if-range", tag)).await;
    assert_eq!(part.status, StatusCode::PARTIAL_CONTENT);
    assert_eq!(part.bytes, whole.bytes[length / 2..length - 1]);
    let told = part.header("content-range");
    assert_eq!(told, format!("bytes {}-{}/{length}", length / 2, length - 2));
    let other = ask(server.get(&path).header("range", &range).header("if-range", "\"x\"")).await;
    assert_eq!((other.status, other.bytes.len()), (StatusCode::OK, length));
    let known = ask(server.get(&path).header("if-none-match", tag)).await;
    assert_eq!((known.status, known.bytes.len()), (StatusCode::NOT_MODIFIED, 0));
    let head = ask(server.request(reqwest::Method::HEAD, &path)).await;
    assert_eq!(head.header("content-length"), length.to_string());

    // The copy of one that is not read goes with its connection, and has no name.
    let reader = send(&server, &get(&path)).await;
    assert_eq!(reader.peek(&mut [0]).await.unwrap(), 1, "the answer has begun");
    for object in on.objects() {
        let mut bytes = std::fs::read(&object).unwrap();
        bytes[1000] ^= 1;
        std::fs::write(&object, bytes).unwrap();
    }
    ask(server.get(&path)).await.problem(500, "integrity");
}
