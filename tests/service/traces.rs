//! Traces: what a collector of OpenTelemetry is told of requests and jobs, and that the service needs none.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use opentelemetry_proto::tonic::trace::v1::span::SpanKind;
use reqwest::StatusCode;
use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};

use crate::collector::{CLIENT, Collector, TRACE, job_in_a_trace};
use crate::helpers::{SMALL, Server, ask, serve};
use crate::processes::is_quick;

fn attributes(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
}

/// Of a prediction.
const PHASES: [&str; 8] =
    ["validate", "assemble", "solve", "estimate", "surface", "compare", "write", "publish"];

/// The collector answers on a thread of its own while this one waits for the end: a server that ends before it is answered
/// closes its connection, and what it sent is lost now and then.
#[tokio::test(flavor = "multi_thread")]
async fn a_request_a_job_and_its_phases_are_spans_of_the_clients_trace() {
    let mut collector = Collector::start().await;
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let mut command = serve(&folder.path().join("data"));
    command.args(["--traces", &collector.address]).stderr(std::fs::File::create(&log).unwrap());
    let server = Server::start_command(command, TempDir::new().unwrap());
    let mut case = SMALL.case();
    case["name"] = "Jane Roe".into();
    let stored = ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await;
    let case = stored.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let id = job_in_a_trace(&server, &case).await;
    ask(server.get(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    assert!(server.terminate_within(Duration::from_secs(60)));

    let posted = collector.span("POST /v1/jobs").await;
    assert_eq!((posted.trace.as_str(), posted.parent.as_str()), (TRACE, CLIENT));
    assert_eq!(posted.kind, SpanKind::Server);
    let answered = [
        ("http.request.method", "POST"),
        ("http.route", "/v1/jobs"),
        ("http.response.status_code", "200"),
    ];
    assert_eq!(posted.attributes, attributes(&answered));
    for (name, value) in
        [("service.name", "facies"), ("service.version", env!("CARGO_PKG_VERSION"))]
    {
        assert_eq!(posted.service[name], value);
    }
    assert_eq!(posted.service["service.instance.id"].len(), 36);

    let attempt = collector.span("job predict").await;
    assert_eq!((&attempt.trace, &attempt.parent), (&posted.trace, &posted.id));
    let job = [("job.id", &*id), ("job.kind", "predict"), ("job.attempt", "1")];
    let ended = [("job.status", "successful")];
    assert_eq!(attempt.attributes, attributes(&[&job[..], &ended].concat()));
    let phases = collector.inside(&attempt);
    let names: Vec<&str> = phases.iter().map(|phase| phase.name.as_str()).collect();
    assert_eq!(names, PHASES);
    for (phase, next) in phases.iter().zip(phases.iter().skip(1)) {
        assert_eq!(phase.trace, TRACE);
        assert!(attempt.begun <= phase.begun && phase.ended <= next.begun, "{phase:?}");
    }
    assert!(phases.last().unwrap().ended <= attempt.ended);

    let asked = collector.span("GET /v1/jobs/{id}").await;
    assert_eq!(asked.parent, "", "a client without a trace begins one");
    let text = std::fs::read_to_string(&log).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let is_logged = |name: &str, value: &str, trace: &str| {
        let spans = lines.iter().map(|line| (line, &line["span"]));
        let of = |(line, span): (&Value, &Value)| {
            (line[name] == value || span[name] == value) && span["trace.id"] == trace
        };
        spans.into_iter().any(of)
    };
    assert!(is_logged("http.route", "/v1/jobs/{id}", &asked.trace), "{text}");
    assert!(is_logged("message", "job ended", TRACE), "{text}");

    let told = String::from_utf8_lossy(&collector.told.borrow().bytes).into_owned();
    assert!(told.contains("job predict"), "the bytes are searched as they are");
    for text in ["Jane", "bone", "z_min", "middle", &case] {
        assert!(!told.contains(text), "{text}");
    }
}

#[tokio::test]
async fn a_client_that_does_not_sample_is_followed() {
    let mut collector = Collector::start().await;
    let server = Server::start_with(&["--traces", &collector.address]);
    let quiet = server.get("/v1/limits").header("traceparent", format!("00-{TRACE}-{CLIENT}-00"));
    ask(quiet).await.expect(StatusCode::OK);
    ask(server.get("/nothing")).await;
    ask(server.get("/v1/jobs/nothing")).await;
    // Spans go in the order in which they end.
    collector.span("GET /v1/jobs/{id}").await;
    let unmatched = collector.span("GET").await;
    assert!(!unmatched.attributes.contains_key("http.route"));
    assert!(collector.told.borrow().spans.iter().all(|span| span.trace != TRACE));
}

/// The collector answers on a thread of its own, as above.
#[tokio::test(flavor = "multi_thread")]
async fn what_has_ended_is_reported_before_the_process_ends() {
    let mut collector = Collector::start().await;
    // Without workers the end takes milliseconds, and spans wait a second for others.
    let server = Server::start_with(&["--traces", &collector.address, "--workers", "0"]);
    ask(server.get("/v1/limits")).await.expect(StatusCode::OK);
    assert!(server.terminate_within(Duration::from_secs(60)));
    let told = &collector.told.borrow_and_update().spans;
    assert!(told.iter().any(|span| span.name == "GET /v1/limits"), "{told:?}");
}

/// A collector that does something to everyone who connects, for as long as the test lives.
async fn collector_with<Done: Future<Output = ()> + Send>(
    does: impl Fn(TcpStream) -> Done + Copy + Send + 'static,
) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        loop {
            let (stream, _) = listener.accept().await.unwrap();
            tokio::spawn(async move { does(stream).await });
        }
    });
    format!("http://{address}")
}

async fn answer(mut stream: TcpStream, text: &str) {
    let _ = stream.read(&mut [0; 1024]).await;
    let _ = stream.write_all(text.as_bytes()).await;
}

/// A job is done in its time beside a collector of no use, its spans are counted as lost, and the service ends.
async fn collects_nothing(name: &str, collector: String) {
    let arguments = ["--traces", &collector, "--admin-bind", "127.0.0.1:0"];
    let mut server = Server::start_with(&arguments);
    let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
    let case = server.case(&SMALL).await;
    // A job of milliseconds; one that waited for its spans would take 5 s for each batch.
    let quick = is_quick(Duration::from_secs(4), async || {
        let id = job_in_a_trace(&server, &case).await;
        assert_eq!(server.ended(&id).await["status"], "successful", "{name}");
    });
    assert!(quick.await, "{name}: it waits for its spans");
    let is_counted = async || {
        let counted = ask(server.client.get(&metrics)).await.bytes;
        let counted = String::from_utf8(counted).unwrap();
        counted.contains("facies_spans_lost_total{cause=\"collector\"} ")
    };
    let until = Instant::now() + Duration::from_secs(30);
    while !is_counted().await {
        assert!(Instant::now() < until, "{name}: no span was counted as lost");
    }
    ask(server.get("/v1/limits")).await.expect(StatusCode::OK);
    // Two seconds for the last spans, and some for a machine with other things to do.
    let ended = move || server.terminate_within(Duration::from_secs(9));
    assert!(tokio::task::spawn_blocking(ended).await.unwrap(), "{name}");
}

#[tokio::test]
async fn a_collector_that_is_dead_slow_or_talks_nonsense_changes_nothing() {
    let dead = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let dead = format!("http://{}", dead.local_addr().unwrap());
    let silent = collector_with(async |stream| {
        let _kept = stream;
        std::future::pending().await
    });
    let nonsense = collector_with(async |stream| answer(stream, "what?\r\n\r\n").await);
    let refusing = collector_with(async |stream| {
        answer(stream, "HTTP/1.1 503 Busy\r\nRetry-After: 600\r\nContent-Length: 0\r\n\r\n").await;
    });
    tokio::join!(
        collects_nothing("dead", dead),
        collects_nothing("silent", silent.await),
        collects_nothing("nonsense", nonsense.await),
        collects_nothing("refusing", refusing.await),
    );
}
