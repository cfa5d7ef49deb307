//! Traces that processes on several hosts tell together.

use tempfile::TempDir;

use crate::collector::{Collector, Span, TRACE, job_in_a_trace};
use crate::deployments::Deployment;
use crate::helpers::{SMALL, Server, serve_shared};
use crate::support::trials::trials;
use crate::workers::Worker;

trials! {
    on_shared {
        a_worker_on_another_host_continues_the_trace
    }
}

async fn a_worker_on_another_host_continues_the_trace(on: Deployment) {
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
