//! Traces: what a collector of OpenTelemetry is told of requests and jobs, and that the service needs none.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::routing::post;
use opentelemetry_proto::tonic::collector::trace::v1::ExportTraceServiceRequest;
use opentelemetry_proto::tonic::common::v1::{KeyValue, any_value};
use opentelemetry_proto::tonic::trace::v1::span::SpanKind;
use prost::Message as _;
use reqwest::StatusCode;
use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

use crate::deployments::Deployment;
use crate::helpers::{SMALL, Server, ask, serve, serve_shared, spec};
use crate::worker::hosts::Worker;

const TRACE: &str = "0af7651916cd43dd8448eb211c80319c";
const CLIENT: &str = "b7ad6b7169203331";

/// A span in words.
#[derive(Clone, Debug)]
struct Span {
    name: String,
    trace: String,
    id: String,
    parent: String,
    kind: SpanKind,
    begun: u64,
    ended: u64,
    attributes: BTreeMap<String, String>,
    /// The process that it comes from.
    service: BTreeMap<String, String>,
}

/// What was told: the spans, and every byte.
#[derive(Default)]
struct Told {
    spans: Vec<Span>,
    bytes: Vec<u8>,
}

struct Collector {
    address: String,
    told: watch::Receiver<Told>,
}

impl Collector {
    async fn start() -> Collector {
        let (teller, told) = watch::channel(Told::default());
        let take = post(async move |body: Bytes| {
            let request = ExportTraceServiceRequest::decode(&*body).unwrap();
            teller.send_modify(|told| {
                told.spans.extend(spans_of(request));
                told.bytes.extend(&body);
            });
        });
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = format!("http://{}", listener.local_addr().unwrap());
        let answers = axum::Router::new().route("/v1/traces", take);
        tokio::spawn(async move { axum::serve(listener, answers).await.unwrap() });
        Collector { address, told }
    }

    /// The span of this name, once it was told.
    async fn span(&mut self, name: &str) -> Span {
        let is_told = |told: &Told| told.spans.iter().any(|span| span.name == name);
        let wait = tokio::time::timeout(Duration::from_secs(30), self.told.wait_for(is_told));
        let told = wait.await.unwrap_or_else(|_| panic!("no span {name} was told")).unwrap();
        told.spans.iter().find(|span| span.name == name).unwrap().clone()
    }

    /// The spans inside another one, in their order.
    fn inside(&self, parent: &Span) -> Vec<Span> {
        let told = self.told.borrow();
        let inside = told.spans.iter().filter(|span| span.parent == parent.id);
        let mut inside: Vec<Span> = inside.cloned().collect();
        inside.sort_by_key(|span| span.begun);
        inside
    }
}

fn spans_of(request: ExportTraceServiceRequest) -> Vec<Span> {
    let mut spans = Vec::new();
    for group in request.resource_spans {
        let service = words(group.resource.unwrap().attributes);
        for span in group.scope_spans.into_iter().flat_map(|scope| scope.spans) {
            spans.push(Span {
                kind: span.kind(),
                trace: hex(&span.trace_id),
                id: hex(&span.span_id),
                parent: hex(&span.parent_span_id),
                name: span.name,
                begun: span.start_time_unix_nano,
                ended: span.end_time_unix_nano,
                attributes: words(span.attributes),
                service: service.clone(),
            });
        }
    }
    spans
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn words(attributes: Vec<KeyValue>) -> BTreeMap<String, String> {
    let word = |attribute: KeyValue| {
        let value = match attribute.value.unwrap().value.unwrap() {
            any_value::Value::StringValue(text) => text,
            any_value::Value::IntValue(number) => number.to_string(),
            other => panic!("{other:?}"),
        };
        (attribute.key, value)
    };
    attributes.into_iter().map(word).collect()
}

fn attributes(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
}

/// Posts a job in the trace of a client; its id, once it has ended.
async fn job_in_a_trace(server: &Server, case: &str) -> String {
    let request = server.post("/v1/jobs").header("prefer", "wait=30").json(&spec(case, 1.0));
    let request = request.header("traceparent", format!("00-{TRACE}-{CLIENT}-01"));
    let job = ask(request).await.expect(StatusCode::OK);
    job["id"].as_str().unwrap().to_owned()
}

#[tokio::test]
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
    assert!(server.terminate_within(Duration::from_secs(10)));

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
    let told = ["validate", "assemble", "solve", "surface", "compare", "write", "publish"];
    assert_eq!(names, told);
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

/// The collector answers on a thread of its own while this one waits for the end.
#[tokio::test(flavor = "multi_thread")]
async fn what_has_ended_is_told_before_the_process_ends() {
    let mut collector = Collector::start().await;
    // Without workers the end takes milliseconds, and spans wait a second for others.
    let server = Server::start_with(&["--traces", &collector.address, "--workers", "0"]);
    ask(server.get("/v1/limits")).await.expect(StatusCode::OK);
    assert!(server.terminate_within(Duration::from_secs(10)));
    let told = &collector.told.borrow_and_update().spans;
    assert!(told.iter().any(|span| span.name == "GET /v1/limits"), "{told:?}");
}

#[tokio::test]
async fn a_worker_on_another_host_continues_the_trace() {
    let Some(on) = Deployment::shared().await else { return };
    let mut collector = Collector::start().await;
    let traced = ["--traces", &collector.address];
    let mut command = serve_shared(&on);
    command.args(["--workers", "0"]).args(traced);
    let api = Server::start_command(command, TempDir::new().unwrap());
    let (_worker, _said) = Worker::start_with(&on, &traced);
    let case = api.case(&SMALL).await;
    job_in_a_trace(&api, &case).await;
    let posted = collector.span("POST /v1/jobs").await;
    let attempt = collector.span("job predict").await;
    assert_eq!((attempt.trace.as_str(), &attempt.parent), (TRACE, &posted.id));
    let instance = |span: &Span| span.service["service.instance.id"].clone();
    assert_ne!(instance(&posted), instance(&attempt));
}

/// A collector that does something to everyone who connects, for as long as the test lives.
async fn collector_that<Done: Future<Output = ()> + Send>(
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

#[tokio::test]
async fn a_collector_that_is_dead_slow_or_talks_nonsense_changes_nothing() {
    let dead = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let dead = format!("http://{}", dead.local_addr().unwrap());
    let silent = collector_that(async |stream| {
        let _kept = stream;
        std::future::pending().await
    });
    let nonsense = collector_that(async |stream| answer(stream, "what?\r\n\r\n").await);
    let refusing = collector_that(async |stream| {
        answer(stream, "HTTP/1.1 503 Busy\r\nRetry-After: 600\r\nContent-Length: 0\r\n\r\n").await;
    });
    for (name, collector) in [
        ("dead", dead),
        ("silent", silent.await),
        ("nonsense", nonsense.await),
        ("refusing", refusing.await),
    ] {
        let arguments = ["--traces", &collector, "--admin-bind", "127.0.0.1:0"];
        let mut server = Server::start_with(&arguments);
        let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
        let case = server.case(&SMALL).await;
        let begun = Instant::now();
        let id = job_in_a_trace(&server, &case).await;
        assert_eq!(server.ended(&id).await["status"], "successful", "{name}");
        // A job of milliseconds; one that waited for its spans would take 5 s for each batch.
        assert!(begun.elapsed() < Duration::from_secs(4), "{name}: {:?}", begun.elapsed());
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
        assert!(server.terminate_within(Duration::from_secs(5)), "{name}");
    }
}
