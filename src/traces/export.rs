//! Export of ended spans to the collector: a bounded queue and a thread of its own, so that a slow, silent or missing
//! collector blocks nobody. Spans that do not reach it are counted.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use opentelemetry::trace::TracerProvider as _;
use opentelemetry::{Context, KeyValue};
use opentelemetry_otlp::{ExporterBuildError, Protocol, WithExportConfig as _};
use opentelemetry_sdk::Resource;
use opentelemetry_sdk::error::OTelSdkResult;
use opentelemetry_sdk::trace::{
    BatchConfigBuilder, BatchSpanProcessor, SdkTracer, SdkTracerProvider, Span, SpanData,
    SpanExporter, SpanProcessor,
};

use crate::metrics;

/// Spans that may wait for the collector, one under way included.
const QUEUE: usize = 4096;
/// How long a span waits for others to go with.
const GATHERED: Duration = Duration::from_secs(1);
/// How long the collector may take to answer, with all tries.
const ANSWER: Duration = Duration::from_secs(5);
/// How long the end of the process waits for the last spans.
const LAST_SPANS: Duration = Duration::from_secs(2);

static TRACES: OnceLock<(SdkTracerProvider, SdkTracer)> = OnceLock::new();

#[derive(Debug, thiserror::Error)]
#[error("traces: {0}")]
pub struct TracesError(#[from] ExporterBuildError);

/// Begins to send spans to the collector at this address, if there is one; a second call changes nothing.
pub fn start(collector: Option<&str>) -> Result<(), TracesError> {
    let Some(address) = collector.filter(|_| TRACES.get().is_none()) else { return Ok(()) };
    // The client of HTTP takes the cryptography of this process; another part may have named the same before.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let exporter = opentelemetry_otlp::SpanExporter::builder()
        .with_http()
        .with_protocol(Protocol::HttpBinary)
        .with_endpoint(format!("{address}/v1/traces"))
        .with_timeout(ANSWER)
        .build()?;
    let resource = Resource::builder().with_service_name("facies").with_attributes([
        KeyValue::new("service.version", env!("CARGO_PKG_VERSION")),
        KeyValue::new("service.instance.id", uuid::Uuid::now_v7().to_string()),
    ]);
    let provider = SdkTracerProvider::builder()
        .with_resource(resource.build())
        .with_span_processor(Queue::new(exporter))
        .build();
    let tracer = provider.tracer("facies");
    // What another thread has started meanwhile stays.
    TRACES.get_or_init(|| (provider, tracer));
    Ok(())
}

/// The tracer; none where traces are off.
pub(super) fn tracer() -> Option<&'static SdkTracer> {
    TRACES.get().map(|(_, tracer)| tracer)
}

/// Sends what has ended, and waits for that no longer than two seconds. Blocks; not for an async thread.
pub fn stop() {
    let Some((provider, _)) = TRACES.get() else { return };
    if let Err(error) = provider.shutdown_with_timeout(LAST_SPANS) {
        tracing::warn!(%error, "the last spans were given up");
    }
}

/// The library's queue, behind a bound that counts what it turns away.
#[derive(Debug)]
struct Queue {
    next: BatchSpanProcessor,
    waiting: Arc<AtomicUsize>,
}

impl Queue {
    fn new(exporter: impl SpanExporter + 'static) -> Queue {
        let waiting = Arc::<AtomicUsize>::default();
        let counted =
            CountingExporter { next: exporter, waiting: waiting.clone(), fails: false.into() };
        let config = BatchConfigBuilder::default()
            .with_max_queue_size(QUEUE)
            .with_scheduled_delay(GATHERED)
            .build();
        let next = BatchSpanProcessor::builder(counted).with_batch_config(config).build();
        Queue { next, waiting }
    }
}

impl SpanProcessor for Queue {
    fn on_start(&self, _span: &mut Span, _context: &Context) {}

    fn on_end(&self, span: SpanData) {
        if self.waiting.fetch_add(1, Ordering::Relaxed) < QUEUE {
            return self.next.on_end(span);
        }
        self.waiting.fetch_sub(1, Ordering::Relaxed);
        metrics::spans_lost("queue", 1);
    }

    fn force_flush(&self) -> OTelSdkResult {
        self.next.force_flush()
    }

    fn shutdown_with_timeout(&self, timeout: Duration) -> OTelSdkResult {
        self.next.shutdown_with_timeout(timeout)
    }

    fn set_resource(&mut self, resource: &Resource) {
        self.next.set_resource(resource);
    }
}

/// An exporter whose failures are counted, and told when they begin and end.
#[derive(Debug)]
struct CountingExporter<E> {
    next: E,
    waiting: Arc<AtomicUsize>,
    fails: AtomicBool,
}

impl<E: SpanExporter> SpanExporter for CountingExporter<E> {
    async fn export(&self, batch: Vec<SpanData>) -> OTelSdkResult {
        let spans = batch.len();
        let exported = self.next.export(batch).await;
        self.waiting.fetch_sub(spans, Ordering::Relaxed);
        let failed_before = self.fails.swap(exported.is_err(), Ordering::Relaxed);
        match &exported {
            Err(error) => {
                metrics::spans_lost("collector", spans as u64);
                if !failed_before {
                    tracing::warn!(%error, "spans do not reach their collector");
                }
            }
            Ok(()) if failed_before => tracing::info!("spans reach their collector again"),
            Ok(()) => {}
        }
        exported
    }

    fn shutdown_with_timeout(&self, timeout: Duration) -> OTelSdkResult {
        self.next.shutdown_with_timeout(timeout)
    }

    fn set_resource(&mut self, resource: &Resource) {
        self.next.set_resource(resource);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::mpsc::{Receiver, channel};
    use std::time::Instant;

    use opentelemetry::InstrumentationScope;
    use opentelemetry::trace::{SpanContext, SpanId, SpanKind, Status};
    use opentelemetry_sdk::trace::{SpanEvents, SpanLinks};

    use super::*;

    /// A collector that answers when it is told to.
    #[derive(Debug)]
    struct StalledCollector(Mutex<Receiver<()>>);

    impl SpanExporter for StalledCollector {
        async fn export(&self, _batch: Vec<SpanData>) -> OTelSdkResult {
            // The other end is dropped to let everything go.
            let _ = self.0.lock().unwrap().recv();
            Ok(())
        }
    }

    fn span() -> SpanData {
        SpanData {
            span_context: SpanContext::empty_context(),
            parent_span_id: SpanId::INVALID,
            parent_span_is_remote: false,
            span_kind: SpanKind::Internal,
            name: "solve".into(),
            start_time: std::time::SystemTime::UNIX_EPOCH,
            end_time: std::time::SystemTime::UNIX_EPOCH,
            attributes: Vec::new(),
            dropped_attributes_count: 0,
            events: SpanEvents::default(),
            links: SpanLinks::default(),
            status: Status::Unset,
            instrumentation_scope: InstrumentationScope::default(),
        }
    }

    #[test]
    fn spans_beyond_the_queue_are_counted_and_nobody_waits_for_the_collector() {
        metrics::start().unwrap();
        let (let_go, held) = channel();
        let queue = Queue::new(StalledCollector(held.into()));
        let begun = Instant::now();
        for _ in 0..QUEUE + 7 {
            queue.on_end(span());
        }
        // Some milliseconds; a collector that was waited for would never answer.
        assert!(begun.elapsed() < Duration::from_secs(2));
        assert!(metrics::render(None).contains("facies_spans_lost_total{cause=\"queue\"} 7"));
        let begun = Instant::now();
        assert!(queue.shutdown_with_timeout(Duration::from_millis(50)).is_err());
        assert!(begun.elapsed() < Duration::from_secs(2));
        drop(let_go);
    }
}
