//! Requests that are wrong as HTTP. The first word of a name is the row of the list of bad inputs.

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::api::tenants::Hospital;
use crate::helpers::{SMALL, Server, ask, serve, spec};

#[tokio::test]
async fn what_is_not_there_is_not_found_and_what_is_not_allowed_is_reported() {
    let server = Server::start();
    let nobody = uuid::Uuid::now_v7();
    for path in [
        "/nothing".to_owned(),
        "/v1/".to_owned(),
        format!("/v1/meshes/{nobody}"),
        format!("/v1/meshes/{nobody}/content"),
        format!("/v1/cases/{nobody}"),
        format!("/v1/cases/{nobody}/plans/{nobody}"),
        "/v1/cases/..%2f..%2fetc".to_owned(),
        "/v1/cases/%2e%2e%2f".to_owned(),
        "/v1/cases/%00".to_owned(),
        format!("/v1/cases/{}", nobody.simple()),
    ] {
        ask(server.get(&path)).await.problem_of(&path, 404, "not-found");
    }
    for path in [format!("/v1/jobs/{nobody}/results"), format!("/v1/jobs/{nobody}/results/x")] {
        ask(server.get(&path)).await.problem_of(&path, 404, "no-such-job");
    }
    let answer = ask(server.get("/v1/cases/%ff")).await;
    assert!(answer.status.is_client_error());
    for (method, path, allow) in [
        (Method::TRACE, "/v1/jobs", "GET,HEAD,POST"),
        (Method::DELETE, "/v1/jobs", "GET,HEAD,POST"),
        (Method::PATCH, "/healthz", "GET,HEAD"),
        (Method::POST, "/openapi.json", "GET,HEAD"),
    ] {
        let answer = ask(server.request(method, path)).await;
        answer.problem_of(path, 405, "method-not-allowed");
        let mut told: Vec<&str> = answer.header("allow").split(',').collect();
        told.sort_unstable();
        assert_eq!(told.join(","), allow);
    }
    let override_ = server.get("/v1/jobs").header("x-http-method-override", "DELETE");
    ask(override_).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn answers_that_the_client_does_not_take_are_not_sent() {
    let server = Server::start();
    for accept in ["image/png", "text/html", "application/json;q=0", "*/*;q=0"] {
        let answer = ask(server.get("/v1/limits").header("accept", accept)).await;
        answer.problem_of(&format!("77 {accept}"), 406, "not-acceptable");
    }
    let answer = ask(server.get("/v1/limits").header("accept", "text/html, */*;q=0.1")).await;
    answer.expect(StatusCode::OK);
}

#[tokio::test]
async fn an_empty_tag_and_a_second_key_are_refused() {
    let server = Server::start();
    for path in ["/v1/jobs?tag=", "/v1/cases?tag=", "/v1/jobs?tag=%20"] {
        let problem = ask(server.get(path)).await.problem_of(path, 400, "invalid-parameter");
        assert_eq!(problem["parameter"], "tag");
    }
    let named = |key: &str| server.get("/v1/jobs").header("authorization", format!("Bearer {key}"));
    let twice = ask(named("a").header("authorization", "Bearer b")).await;
    twice.problem(400, "malformed-request");
}

#[tokio::test]
async fn bodies_of_another_kind_are_not_read() {
    let server = Server::start();
    for (path, kind) in [
        ("/v1/jobs", "text/plain"),
        ("/v1/jobs", ""),
        ("/v1/jobs", "application/x-www-form-urlencoded"),
        ("/v1/cases", "application/xml"),
        ("/v1/meshes", "image/png"),
        ("/v1/meshes", "application/x-tar"),
    ] {
        let answer = ask(server.post(path).header("content-type", kind).body("{}")).await;
        answer.problem_of(kind, 415, "unsupported-media-type");
        assert!(!answer.header("accept-post").is_empty());
    }
    let form = server.post("/v1/meshes").header("content-type", "multipart/form-data").body("x");
    ask(form).await.problem_of("76 no boundary", 400, "malformed-multipart");
    let mut parts = reqwest::multipart::Form::new();
    for number in 0..1000 {
        parts = parts.text(format!("part-{number}"), "x");
    }
    let answer = ask(server.post("/v1/cases").multipart(parts)).await;
    assert_eq!(answer.problem_of("76 1000 parts", 413, "payload-too-large")["limit"], 32);
    let unnamed = "--b\r\nContent-Disposition: form-data\r\n\r\nx\r\n--b--\r\n";
    let form = server.post("/v1/cases").header("content-type", "multipart/form-data; boundary=b");
    ask(form.body(unnamed)).await.problem_of("76 no name", 400, "malformed-multipart");
}

#[tokio::test]
async fn what_is_too_long_is_refused_with_its_limit() {
    let server = Server::start_with(&["--upload-mib", "1"]);
    let long = ask(server.get(&format!("/v1/cases/{}", "x".repeat(10_000)))).await;
    assert_eq!(long.problem_of("70 10 kB", 414, "uri-too-long")["limit"], 8192);
    let head = ask(server.get("/v1/limits").header("x-long", "x".repeat(20_000))).await;
    assert_eq!(head.problem_of("73 20 kB", 431, "header-too-large")["limit"], 16384);
    let bytes = vec![b' '; (1 << 20) + 1];
    let request = || server.post("/v1/meshes").header("content-type", "model/stl");
    let declared = ask(request().body(bytes.clone())).await;
    assert_eq!(declared.problem(413, "payload-too-large")["limit"], 1 << 20);
    let frames = futures::stream::iter(
        bytes.chunks(1 << 16).map(|c| Ok::<_, std::io::Error>(c.to_vec())).collect::<Vec<_>>(),
    );
    let chunked = request().body(reqwest::Body::wrap_stream(frames)).send().await;
    // The server may close the connection before the last chunk was sent.
    if let Ok(answer) = chunked {
        assert_eq!(answer.status(), StatusCode::PAYLOAD_TOO_LARGE);
    }
    assert_eq!(ask(server.get("/v1/limits")).await.json()["upload_bytes"], 1 << 20);
}

#[tokio::test]
async fn the_id_of_a_request_comes_back_unless_it_could_forge_a_log() {
    let server = Server::start();
    let given = ask(server.get("/nothing").header("x-request-id", "a-B_1.2")).await;
    assert_eq!(given.problem(404, "not-found")["instance"], "a-B_1.2");
    for forged in ["a b", "a\"b", "{}", &"x".repeat(65)] {
        let answer = ask(server.get("/healthz").header("x-request-id", forged)).await;
        let id = answer.header("x-request-id");
        assert!(id != forged && uuid::Uuid::try_parse(id).is_ok(), "73 {forged}");
    }
}

/// Sends text as it is and reads until the server closes.
async fn raw(server: &Server, text: &str) -> String {
    let mut connection = TcpStream::connect(server.host()).await.unwrap();
    connection.write_all(text.as_bytes()).await.unwrap();
    let mut answer = String::new();
    connection.read_to_string(&mut answer).await.unwrap();
    answer
}

#[tokio::test]
async fn a_body_that_stops_coming_is_given_up() {
    let server = Server::start_with(&["--body-idle-s", "0.2"]);
    let head = "POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/stl\r\nContent-Length: 99\r\n\r\nsolid";
    let answer = raw(&server, head).await;
    assert!(answer.starts_with("HTTP/1.1 408"), "74 {answer}");
    assert!(answer.contains("\"code\":\"request-timeout\""), "{answer}");
    let smuggled = "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n";
    let answer = raw(&server, smuggled).await;
    assert!(answer.starts_with("HTTP/1.1 4") || answer.is_empty(), "72 {answer}");
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap().count();
    assert_eq!(blobs, 0);
    server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn what_has_no_certain_length_is_refused_and_its_connection_closed() {
    let server = Server::start_with(&["--workers", "0"]);
    let chunked = "Transfer-Encoding: chunked\r\n\r\n";
    for (name, rest) in [
        ("72 two lengths", "Content-Length: 2\r\nContent-Length: 3\r\n\r\n{}".to_owned()),
        ("72 a length that is none", "Content-Length: +2\r\n\r\n{}".to_owned()),
        ("72 no size of a chunk", format!("{chunked}FFFFFFFFFFFFFFFFF\r\n{{}}\r\n0\r\n\r\n")),
        ("72 a chunk with a bare LF", format!("{chunked}2\n{{}}\n0\n\n")),
        (
            "72 a coding besides chunks",
            "Transfer-Encoding: gzip, chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n".to_owned(),
        ),
        (
            "72 chunks twice",
            "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n"
                .to_owned(),
        ),
        (
            "72 less than the length",
            "Content-Length: 2\r\n\r\n{} /v1/jobs HTTP/1.1\r\n\r\n".to_owned(),
        ),
    ] {
        let head =
            "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n";
        let answer = raw(&server, &format!("{head}{rest}")).await;
        for line in answer.lines().filter(|line| line.starts_with("HTTP/1.1")) {
            assert!(line.starts_with("HTTP/1.1 4"), "{name}: {answer}");
        }
        assert!(answer.contains("HTTP/1.1 400"), "{name}: {answer}");
    }
    let mut broken_off = TcpStream::connect(server.host()).await.unwrap();
    let head = "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{";
    broken_off.write_all(head.as_bytes()).await.unwrap();
    broken_off.shutdown().await.unwrap();
    let mut answer = String::new();
    broken_off.read_to_string(&mut answer).await.unwrap();
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 400"), "72 {answer}");
    ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_cursor_of_another_tenant_shows_nothing_of_theirs() {
    let hospital = Hospital::open();
    let (ours, theirs) =
        (hospital.key("a", &["read", "write"]).await, hospital.key("b", &["read"]).await);
    for name in ["one", "two"] {
        let mut case = SMALL.case();
        case["name"] = name.into();
        let form =
            hospital.server.post("/v1/cases").bearer_auth(&ours).multipart(SMALL.form(&case));
        ask(form).await.expect(StatusCode::CREATED);
    }
    let page = hospital.get(&ours, "/v1/cases?limit=1").await.expect(StatusCode::OK);
    let next = format!("/v1/cases?cursor={}", page["next"].as_str().unwrap());
    let rest = |page: Value| page["items"].as_array().unwrap().len();
    assert_eq!(rest(hospital.get(&ours, &next).await.expect(StatusCode::OK)), 1);
    assert_eq!(rest(hospital.get(&theirs, &next).await.expect(StatusCode::OK)), 0, "81");
}

#[tokio::test]
async fn names_that_could_do_harm_come_back_as_they_are_and_never_reach_the_log() {
    let folder = tempfile::TempDir::new().unwrap();
    let log = folder.path().join("log");
    let mut command = serve(folder.path());
    command.args(["--workers", "0", "--log-level", "debug"]);
    command.stderr(std::fs::File::create(&log).unwrap());
    let server = Server::start_command(command, folder);
    for name in ["=cmd|' /C calc'!A0", "<script>alert(1)</script>", "\u{202e}gnp.exe", "\u{1f9b7}"]
    {
        let mut case = SMALL.case();
        case["name"] = name.into();
        case["tags"] = json!([name]);
        let made = ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await;
        let path = made.header("location").to_owned();
        made.expect(StatusCode::CREATED);
        let kept = ask(server.get(&path)).await;
        assert_eq!(kept.header("content-type"), "application/json", "84 {name}");
        assert_eq!(kept.json()["case"]["name"], name, "84");
        assert_eq!(kept.json()["case"]["tags"], json!([name]), "84");
        let logged = std::fs::read_to_string(&log).unwrap();
        assert!(!logged.contains(name), "84 {name}");
    }
    for name in ["two\nlines", "a\u{0}b", "\u{1b}[31m"] {
        let mut case = SMALL.case();
        case["name"] = name.into();
        let refused = ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await;
        refused.problem_of(&format!("84 {name:?}"), 422, "validation-failed");
    }
}

#[tokio::test]
async fn a_table_has_no_name_that_a_spreadsheet_would_compute() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let truth = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let formula = "=cmd|' /C calc'!A0";
    let study = json!({
        "kind": "study", "scenes": [{"case": case, "name": formula}], "repeats": 1,
        "plans": [{"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]}],
        "methods": ["fem_linear"], "elements": ["auto"], "truth": {"job": truth["id"]},
    });
    let job = server.job(&study).await.expect(StatusCode::OK);
    let path = format!("/v1/jobs/{}/report?format=csv", job["id"].as_str().unwrap());
    let table = String::from_utf8(ask(server.get(&path)).await.bytes).unwrap();
    assert!(table.contains(&format!("\n'{formula},")), "84 {table}");
}

#[tokio::test]
async fn other_origins_are_not_allowed_in() {
    let server = Server::start();
    let request =
        server.request(Method::OPTIONS, "/v1/jobs").header("origin", "https://elsewhere.example");
    let answer = ask(request.header("access-control-request-method", "POST")).await;
    assert!(answer.headers.get("access-control-allow-origin").is_none(), "83");
}
