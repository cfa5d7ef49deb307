//! Metrics of the service, in the words of Prometheus. Every name stands in this file once.

pub mod http;

use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use ::metrics::{
    Unit, counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram,
};
use metrics_exporter_prometheus::{BuildError, Matcher, PrometheusBuilder, PrometheusHandle};

const DATABASE_UP: &str = "facies_database_up";
const QUEUE_JOBS: &str = "facies_queue_jobs";
const QUEUE_AGE: &str = "facies_queue_oldest_seconds";
const ATTEMPTS: &str = "facies_attempts_total";
const ATTEMPT_TIME: &str = "facies_attempt_seconds";
const LOST: &str = "facies_attempts_lost_total";
const JOB_TIME: &str = "facies_job_seconds";
const ITERATIONS: &str = "facies_solver_iterations";
const SLOTS_ENDED: &str = "facies_slot_processes_ended_total";
const JOB_MEMORY: &str = "facies_job_peak_bytes";
const SPANS_LOST: &str = "facies_spans_lost_total";
const RESIDENT: &str = "process_resident_memory_bytes";
const LINES_DROPPED: &str = "facies_log_lines_dropped_total";
const RETENTION_WITHHELD: &str = "facies_retention_withheld";

const SECONDS: [f64; 12] =
    [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3600.0];
const COUNTS: [f64; 9] = [1.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5];
const BYTES: [f64; 9] = [64e6, 128e6, 256e6, 512e6, 1e9, 2e9, 4e9, 8e9, 32e9];

static EXPORTER: OnceLock<PrometheusHandle> = OnceLock::new();

/// Begins to count in this process; a second call changes nothing.
pub fn start() -> Result<(), BuildError> {
    // One thread installs; another that comes meanwhile finds it installed.
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    if EXPORTER.get().is_some() {
        return Ok(());
    }
    let builder = PrometheusBuilder::new()
        .set_buckets_for_metric(Matcher::Suffix("_seconds".into()), &SECONDS)?
        .set_buckets_for_metric(Matcher::Full(http::TIME.into()), &http::SECONDS)?
        .set_buckets_for_metric(Matcher::Full(ITERATIONS.into()), &COUNTS)?
        .set_buckets_for_metric(Matcher::Suffix("_bytes".into()), &BYTES)?;
    let handle = builder.install_recorder()?;
    EXPORTER.get_or_init(|| handle);
    describe();
    Ok(())
}

fn describe() {
    http::describe();
    describe_gauge!(
        DATABASE_UP,
        "1 if the database was asked for the queue, 0 if it did not answer"
    );
    describe_gauge!(QUEUE_JOBS, "jobs that wait (state waiting) or run (state running)");
    describe_gauge!(QUEUE_AGE, Unit::Seconds, "age of the job that has waited longest");
    describe_counter!(ATTEMPTS, "attempts at jobs, by kind of job and by how they ended");
    describe_histogram!(ATTEMPT_TIME, Unit::Seconds, "time of an attempt, by kind of job");
    describe_counter!(LOST, "attempts that lost what computed them, by cause");
    describe_histogram!(
        JOB_TIME,
        Unit::Seconds,
        "time of a successful job, by method and by unknowns (size)"
    );
    describe_histogram!(ITERATIONS, "iterations of the solver in a successful job, by method");
    describe_counter!(SLOTS_ENDED, "processes of slots that were ended or died, by cause");
    describe_histogram!(JOB_MEMORY, Unit::Bytes, "most memory of the process of a job");
    describe_counter!(SPANS_LOST, "spans of traces that did not reach their collector, by cause");
    describe_gauge!(
        RESIDENT,
        Unit::Bytes,
        "memory of this process that is in use, without its slots"
    );
    describe_counter!(
        LINES_DROPPED,
        "lines of the log that were dropped because standard error was not read in time"
    );
    describe_gauge!(RETENTION_WITHHELD, "1 while retention erases nothing because of the clock");
}

/// Everything that was counted, as text for Prometheus; empty before `start`. The queue is in it only if the database was asked for it.
pub fn render(queue: Option<QueueCounts>) -> String {
    gauge!(DATABASE_UP).set(f64::from(u8::from(queue.is_some())));
    if let Some(queue) = queue {
        set_queue(queue);
    }
    let text = EXPORTER.get().map(PrometheusHandle::render).unwrap_or_default();
    match queue {
        Some(_) => text,
        None => without_queue(&text),
    }
}

/// The exporter keeps the last value of a gauge.
fn without_queue(text: &str) -> String {
    let is_queue = |line: &str| line.contains(QUEUE_JOBS) || line.contains(QUEUE_AGE);
    text.split_inclusive('\n').filter(|line| !is_queue(line)).collect()
}

/// Frees the memory of rendered samples; to be called now and then.
pub fn release_memory() {
    if let Some(exporter) = EXPORTER.get() {
        exporter.run_upkeep();
    }
}

/// Jobs that have not ended, and how long the first of those that wait has waited.
#[derive(Clone, Copy, Debug)]
pub struct QueueCounts {
    pub waiting: i64,
    pub running: i64,
    pub oldest_ms: i64,
}

fn set_queue(queue: QueueCounts) {
    gauge!(QUEUE_JOBS, "state" => "waiting").set(queue.waiting as f64);
    gauge!(QUEUE_JOBS, "state" => "running").set(queue.running as f64);
    gauge!(QUEUE_AGE).set(queue.oldest_ms as f64 / 1e3);
    release_memory();
}

/// Whether retention erases nothing because the clock is in doubt.
pub fn retention_withheld(is_withheld: bool) {
    gauge!(RETENTION_WITHHELD).set(f64::from(u8::from(is_withheld)));
}

/// An attempt ended as successful, failed, dismissed, stopped, fenced, lost or unwritten.
pub fn attempt_ended(kind: &str, status: &'static str, took: Duration) {
    let kind = kind.to_owned();
    counter!(ATTEMPTS, "kind" => kind.clone(), "status" => status).increment(1);
    histogram!(ATTEMPT_TIME, "kind" => kind).record(took.as_secs_f64());
}

/// A job was solved.
pub fn job_solved(method: &str, unknowns: u64, iterations: u64, took: Duration) {
    let method = method.to_owned();
    let size = size_class(unknowns);
    histogram!(JOB_TIME, "method" => method.clone(), "size" => size).record(took.as_secs_f64());
    histogram!(ITERATIONS, "method" => method).record(iterations as f64);
}

/// Unknowns to the power of ten above them.
fn size_class(unknowns: u64) -> &'static str {
    match unknowns {
        0 => "none",
        1..10_000 => "below_1e4",
        10_000..100_000 => "below_1e5",
        100_000..1_000_000 => "below_1e6",
        _ => "above_1e6",
    }
}

/// An attempt lost what computed it.
pub fn attempt_lost(cause: &'static str) {
    counter!(LOST, "cause" => cause).increment(1);
}

/// The process of a slot died or was ended, and why.
pub fn slot_ended(cause: &str) {
    counter!(SLOTS_ENDED, "cause" => cause.to_owned()).increment(1);
}

/// The most memory that the process of a job took.
pub fn job_memory(peak_bytes: u64) {
    histogram!(JOB_MEMORY).record(peak_bytes as f64);
}

/// Spans found the queue full, or did not reach the collector.
pub fn spans_lost(cause: &'static str, spans: u64) {
    counter!(SPANS_LOST, "cause" => cause).increment(spans);
}

/// Memory of this process.
pub fn process_memory(bytes: u64) {
    gauge!(RESIDENT).set(bytes as f64);
}

/// A line of the log found no room.
pub fn log_line_dropped() {
    counter!(LINES_DROPPED).increment(1);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_counted_is_rendered() {
        start().unwrap();
        start().unwrap();
        let queue = QueueCounts { waiting: 3, running: 2, oldest_ms: 1500 };
        job_solved("fem_linear", 50_000, 40, Duration::from_millis(20));
        attempt_lost("signal");
        let text = render(Some(queue));
        for line in [
            "facies_database_up 1",
            "facies_queue_jobs{state=\"waiting\"} 3",
            "facies_queue_oldest_seconds 1.5",
            "facies_job_seconds_bucket{method=\"fem_linear\",size=\"below_1e5\",le=\"0.03\"} 1",
            "facies_solver_iterations_sum{method=\"fem_linear\"} 40",
            "facies_attempts_lost_total{cause=\"signal\"} 1",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        let text = render(None);
        assert!(text.contains("facies_database_up 0"), "{text}");
        assert!(
            text.contains("facies_attempts_lost_total") && !text.contains("facies_queue"),
            "{text}"
        );
    }
}
