//! Traces of requests and of attempts at jobs, for a collector of OpenTelemetry. Every span is made in this file, of
//! ids, numbers and words of the program: nothing that a client wrote is in one.

mod export;

use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

use opentelemetry::trace::{
    Span as _, SpanBuilder, SpanContext, SpanId, SpanKind, Status, TraceContextExt as _,
    TraceFlags, TraceId, TraceState, Tracer as _,
};
use opentelemetry::{Context, KeyValue};
use opentelemetry_sdk::trace::{SdkTracer, Span};

use crate::metrics::http::known_method;

pub use export::{TracesError, start, stop};

/// A study of many rows changes its phase thousands of times; the first tell what there is to see.
const PHASES_OF_AN_ATTEMPT: usize = 100;

/// A place in a trace, in the words of W3C Trace Context, level 1, section 3.2.2.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceParent(SpanContext);

impl TraceParent {
    /// `None` where it is none.
    pub fn parse(text: &str) -> Option<TraceParent> {
        let mut parts = text.split('-');
        let mut hex = |length: usize| {
            let digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
            parts.next().filter(|part| part.len() == length && part.bytes().all(digit))
        };
        let (version, trace, span, flags) = (hex(2)?, hex(32)?, hex(16)?, hex(2)?);
        // A later version may say more; what it says first means the same.
        if version == "ff" || (version == "00" && parts.next().is_some()) {
            return None;
        }
        let (trace, span) = (TraceId::from_hex(trace).ok()?, SpanId::from_hex(span).ok()?);
        let flags = TraceFlags::new(u8::from_str_radix(flags, 16).ok()?) & TraceFlags::SAMPLED;
        let place = SpanContext::new(trace, span, flags, true, TraceState::NONE);
        place.is_valid().then_some(TraceParent(place))
    }

    /// The id of the trace.
    pub fn trace_id(&self) -> String {
        self.0.trace_id().to_string()
    }

    /// Where a span is.
    fn of(span: &Span) -> TraceParent {
        TraceParent(span.span_context().clone())
    }
}

impl fmt::Display for TraceParent {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = &self.0;
        let (trace, span, flags) = (place.trace_id(), place.span_id(), place.trace_flags());
        write!(formatter, "00-{trace}-{span}-{flags:02x}")
    }
}

/// Begins a span; without a parent it is the first of its trace.
fn begin(tracer: &SdkTracer, span: SpanBuilder, parent: Option<&TraceParent>) -> Span {
    let context = Context::new();
    let context = match parent {
        Some(TraceParent(place)) => context.with_remote_span_context(place.clone()),
        None => context,
    };
    tracer.build_with_context(span, &context)
}

/// A request from its beginning to the head of its answer. Where traces are off it only knows the trace of its client.
pub struct Request {
    span: Option<Span>,
    parent: Option<TraceParent>,
}

impl Request {
    /// `route` is the pattern of the route, where there is one.
    pub fn begin(method: &str, route: Option<&str>, parent: Option<TraceParent>) -> Request {
        let span = export::tracer().map(|tracer| {
            let known = known_method(method);
            let name = [Some(known.unwrap_or("HTTP")), route].into_iter().flatten();
            let name = name.collect::<Vec<_>>().join(" ");
            let mut attributes =
                vec![KeyValue::new("http.request.method", known.unwrap_or("_OTHER"))];
            attributes.extend(route.map(|route| KeyValue::new("http.route", route.to_owned())));
            let span = SpanBuilder::from_name(name).with_kind(SpanKind::Server);
            begin(tracer, span.with_attributes(attributes), parent.as_ref())
        });
        Request { span, parent }
    }

    /// The id of its trace.
    pub fn trace_id(&self) -> Option<String> {
        self.place().or(self.parent.clone()).map(|place| place.trace_id())
    }

    /// Its own place, for what follows from it; none where traces are off.
    pub fn place(&self) -> Option<TraceParent> {
        self.span.as_ref().map(TraceParent::of)
    }

    /// A request whose client disconnects before the answer has no status.
    pub fn answered(self, status: u16) {
        let Some(mut span) = self.span else { return };
        span.set_attribute(KeyValue::new("http.response.status_code", i64::from(status)));
        if status >= 500 {
            span.set_status(Status::error(""));
        }
    }
}

/// An attempt at a job as its worker sees it, and the phases inside.
pub struct Attempt {
    spans: Option<Mutex<Spans>>,
    trace_id: Option<String>,
}

struct Spans {
    attempt: Span,
    phase: Option<(&'static str, Span)>,
    phases: usize,
}

impl Attempt {
    /// `parent` is where the job was accepted.
    pub fn begin(job: &str, kind: &str, attempt: i64, parent: Option<&str>) -> Attempt {
        let parent = parent.and_then(TraceParent::parse);
        let span = export::tracer().map(|tracer| {
            let span = SpanBuilder::from_name(format!("job {kind}")).with_kind(SpanKind::Consumer);
            let span = span.with_attributes([
                KeyValue::new("job.id", job.to_owned()),
                KeyValue::new("job.kind", kind.to_owned()),
                KeyValue::new("job.attempt", attempt),
            ]);
            begin(tracer, span, parent.as_ref())
        });
        let place = span.as_ref().map(TraceParent::of).or(parent);
        let spans = |attempt| Mutex::new(Spans { attempt, phase: None, phases: 0 });
        Attempt { spans: span.map(spans), trace_id: place.map(|place| place.trace_id()) }
    }

    /// The id of its trace.
    pub fn trace_id(&self) -> Option<&str> {
        self.trace_id.as_deref()
    }

    /// A phase begins, and the one before it has ended; one that is reported twice goes on.
    pub fn phase(&self, name: &'static str) {
        let (Some(mut spans), Some(tracer)) = (self.lock(), export::tracer()) else { return };
        let goes_on = spans.phase.as_ref().is_some_and(|(running, _)| *running == name);
        if goes_on || spans.phases == PHASES_OF_AN_ATTEMPT {
            return;
        }
        spans.phases += 1;
        spans.phase = None;
        let parent = TraceParent::of(&spans.attempt);
        spans.phase = Some((name, begin(tracer, SpanBuilder::from_name(name), Some(&parent))));
    }

    /// The attempt ended with this status.
    pub fn ended(&self, status: &'static str) {
        let Some(mut spans) = self.lock() else { return };
        spans.phase = None;
        spans.attempt.set_attribute(KeyValue::new("job.status", status));
        if matches!(status, "failed" | "lost" | "unwritten") {
            spans.attempt.set_status(Status::error(""));
        }
        spans.attempt.end();
    }

    /// Spans are whole after a panic elsewhere: each change is one step.
    fn lock(&self) -> Option<MutexGuard<'_, Spans>> {
        let spans = self.spans.as_ref()?;
        Some(spans.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_a_trace_is_taken_over_when_it_is_one() {
        let (trace, span) = ("0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331");
        let given = format!("00-{trace}-{span}-01");
        let place = TraceParent::parse(&given).unwrap();
        assert_eq!((place.trace_id().as_str(), place.to_string()), (trace, given));
        let later = TraceParent::parse(&format!("01-{trace}-{span}-03-more")).unwrap();
        assert_eq!(later, place);
        for wrong in [
            format!("ff-{trace}-{span}-01"),
            format!("00-{}-{span}-01", "0".repeat(32)),
            format!("00-{trace}-{}-01", "0".repeat(16)),
            format!("00-{}-{span}-01", trace.to_uppercase()),
            format!("00-{trace}-{span}"),
            format!("00-{trace}-{span}-01-more"),
            format!("00-{trace}"),
            "00-a\"b-c-01".to_owned(),
        ] {
            assert_eq!(TraceParent::parse(&wrong), None, "{wrong}");
        }
    }

    #[test]
    fn without_a_collector_only_the_trace_of_the_client_is_known() {
        let given = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
        let request = Request::begin("GET", Some("/v1/limits"), TraceParent::parse(given));
        assert_eq!(request.trace_id().as_deref(), Some("0af7651916cd43dd8448eb211c80319c"));
        assert_eq!(request.place(), None);
        request.answered(200);
        let attempt = Attempt::begin("id", "predict", 1, None);
        attempt.phase("solve");
        attempt.ended("successful");
        assert_eq!(attempt.trace_id(), None);
    }
}
