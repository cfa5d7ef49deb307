//! A service that asks for no key answers to its machine and its own pages, and to nobody whom a browser brings.

use reqwest::{Method, RequestBuilder, StatusCode};
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use super::tenants::Hospital;
use crate::helpers::{Server, ask};

fn rebound(request: RequestBuilder) -> RequestBuilder {
    request.header("host", "evil.example:8080").header("origin", "http://evil.example:8080")
}

#[tokio::test]
async fn a_name_that_was_made_to_point_here_reads_nothing() {
    let server = Server::start_with(&["--allowed-hosts", "planning"]);
    for path in ["/v1/cases", "/v1/nothing", "/healthz", "/docs/", "/openapi.json"] {
        let refused = ask(rebound(server.get(path))).await;
        let problem = refused.problem_of(path, 421, "unknown-host");
        assert_eq!(problem["host"], "evil.example:8080");
    }
    for host in ["localhost:1", "127.0.0.1", "[::1]:8080", "planning"] {
        let answer = ask(server.get("/v1/cases").header("host", host)).await;
        answer.expect(StatusCode::OK);
    }
}

#[tokio::test]
async fn a_form_of_another_site_changes_nothing() {
    let server = Server::start();
    let form = || {
        let part = reqwest::multipart::Part::text("solid x");
        server.post("/v1/meshes").multipart(reqwest::multipart::Form::new().part("f", part))
    };
    let refused = ask(form().header("sec-fetch-site", "cross-site")).await;
    refused.problem(403, "foreign-origin");
    let refused = ask(form().header("origin", "http://localhost:3000")).await;
    let problem = refused.problem(403, "foreign-origin");
    assert_eq!(problem["origin"], "http://localhost:3000");
    let own = form().header("origin", format!("http://{}", server.host()));
    assert_eq!(ask(own).await.status, StatusCode::UNPROCESSABLE_ENTITY, "it is read");
}

#[tokio::test]
async fn administration_without_a_key_is_not_for_pages_either() {
    let hospital = Hospital::open();
    let wanted = json!({"label": "x", "scopes": ["read", "write", "run", "admin"]});
    let make = || hospital.admin(Method::POST, "/tenants/alpha/keys").json(&wanted);
    ask(rebound(make())).await.problem(421, "unknown-host");
    ask(make().header("sec-fetch-site", "cross-site")).await.problem(403, "foreign-origin");
    let refused = ask(rebound(hospital.admin(Method::GET, "/metrics"))).await;
    refused.problem(421, "unknown-host");
    ask(make()).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn who_has_a_key_may_use_any_name() {
    let hospital = Hospital::open();
    let key = hospital.key("alpha", &["read"]).await;
    let request = rebound(hospital.server.get("/v1/cases")).bearer_auth(key);
    ask(request).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_client_that_knows_no_host_is_answered() {
    let server = Server::start();
    let mut stream = TcpStream::connect(server.host()).await.unwrap();
    stream.write_all(b"GET /healthz HTTP/1.0\r\n\r\n").await.unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.unwrap();
    assert!(answer.starts_with("HTTP/1.0 200"), "{answer}");
}

#[tokio::test]
async fn a_request_of_http_1_1_names_one_host() {
    let hospital = Hospital::open();
    let hosts =
        ["", "Host: localhost\r\nHost: localhost\r\n", "Host: localhost\r\nHost: evil.example\r\n"];
    for host in hosts {
        for at in [hospital.server.host(), hospital.admin_host()] {
            let mut stream = TcpStream::connect(at).await.unwrap();
            let request = format!("GET /healthz HTTP/1.1\r\n{host}Connection: close\r\n\r\n");
            stream.write_all(request.as_bytes()).await.unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).await.unwrap();
            assert!(answer.starts_with("HTTP/1.1 400"), "{host}: {answer}");
            assert!(answer.contains("malformed-request"), "{answer}");
        }
    }
}
