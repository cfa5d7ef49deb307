//! A collector of OpenTelemetry that keeps the spans it is told.

use std::collections::BTreeMap;
use std::time::Duration;

use axum::body::Bytes;
use axum::routing::post;
use opentelemetry_proto::tonic::collector::trace::v1::ExportTraceServiceRequest;
use opentelemetry_proto::tonic::common::v1::{KeyValue, any_value};
use opentelemetry_proto::tonic::trace::v1::span::SpanKind;
use prost::Message as _;
use reqwest::StatusCode;
use tokio::net::TcpListener;
use tokio::sync::watch;

use crate::helpers::{Server, ask, spec};

pub const TRACE: &str = "0af7651916cd43dd8448eb211c80319c";
pub const CLIENT: &str = "b7ad6b7169203331";

/// A span in words.
#[derive(Clone, Debug)]
pub struct Span {
    pub name: String,
    pub trace: String,
    pub id: String,
    pub parent: String,
    pub kind: SpanKind,
    pub begun: u64,
    pub ended: u64,
    pub attributes: BTreeMap<String, String>,
    /// The process that it comes from.
    pub service: BTreeMap<String, String>,
}

/// What was told: the spans, and every byte.
#[derive(Default)]
pub struct Told {
    pub spans: Vec<Span>,
    pub bytes: Vec<u8>,
}

pub struct Collector {
    pub address: String,
    pub told: watch::Receiver<Told>,
}

impl Collector {
    pub async fn start() -> Collector {
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
    pub async fn span(&mut self, name: &str) -> Span {
        let is_told = |told: &Told| told.spans.iter().any(|span| span.name == name);
        let wait = tokio::time::timeout(Duration::from_secs(30), self.told.wait_for(is_told));
        let told = wait.await.unwrap_or_else(|_| panic!("no span {name} was told")).unwrap();
        told.spans.iter().find(|span| span.name == name).unwrap().clone()
    }

    /// The spans inside another one, in their order.
    pub fn inside(&self, parent: &Span) -> Vec<Span> {
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

/// Posts a job in the trace of a client; its id, once it has ended.
pub async fn job_in_a_trace(server: &Server, case: &str) -> String {
    let request = server.post("/v1/jobs").header("prefer", "wait=30").json(&spec(case, 1.0));
    let request = request.header("traceparent", format!("00-{TRACE}-{CLIENT}-01"));
    let job = ask(request).await.expect(StatusCode::OK);
    job["id"].as_str().unwrap().to_owned()
}
