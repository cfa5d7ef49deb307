//! Worker threads: each claims a job, has it computed, and publishes the result. Each slot is a thread; numerics run
//! elsewhere.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::json;
use tokio::runtime::Handle;

use super::fail_point::FailPoints;
use super::heartbeat::{Heartbeat, RunningJob, worker_lost};
use super::publication::Publication;
use super::publisher::Publisher;
use super::storage::StorageWatch;
use super::work::{Failure, Finished, Work};
use crate::config::Config;
use crate::metrics;
use crate::schema::ErrorCode;
use crate::schema::job::ErrorClass;
use crate::store::{Claim, Lease, Store, StoreError};
use crate::traces;
use crate::worker::process::attempt::broke_off;
use crate::worker::process::protocol::Effort;
use mechanics::progress::Progress;

/// How long an idle worker waits before it looks for jobs that another process has accepted.
const IDLE: Duration = Duration::from_secs(1);
/// The pause before a job that lost its process is tried again, times the losses so far.
const PAUSE_AFTER_LOSS: Duration = Duration::from_millis(500);
/// How long a solver that was cancelled may take before the process ends without it.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// How long a slot that is not ready sleeps at most before it looks whether to stop.
const UNREADY: Duration = Duration::from_millis(100);

/// The worker slots of this process.
pub struct Workers {
    shared: Arc<Shared>,
    slots: Vec<JoinHandle<()>>,
}

struct Shared {
    store: Store,
    storage: StorageWatch,
    heartbeat: Heartbeat,
    runtime: Handle,
    lease: Duration,
    attempts: u32,
    stopping: AtomicBool,
}

impl Workers {
    /// Starts the slots, each with work of its own. `runtime` answers their questions to the store.
    pub fn start(
        store: Store,
        config: &Config,
        work: &dyn Fn() -> Box<dyn Work>,
        runtime: Handle,
    ) -> Result<Workers, StoreError> {
        let shared = Arc::new(Shared {
            heartbeat: Heartbeat::start(store.clone(), config)?,
            storage: StorageWatch::new(store.clone(), config.free_space_floor_bytes),
            store,
            runtime,
            lease: config.lease,
            attempts: config.attempts,
            stopping: AtomicBool::new(false),
        });
        let mut slots = Vec::with_capacity(config.workers);
        for slot in 0..config.workers {
            let (shared, mut work) = (shared.clone(), work());
            let thread = std::thread::Builder::new()
                .name(format!("worker-{slot}"))
                .spawn(move || shared.serve(work.as_mut()))?;
            slots.push(thread);
        }
        Ok(Workers { shared, slots })
    }

    /// Claims no more, lets running jobs finish for `grace`, and gives back those that did not.
    /// Blocks; not for an async thread.
    pub fn stop(self, grace: Duration) {
        self.shared.stopping.store(true, Ordering::Relaxed);
        self.wait(grace);
        for job in self.shared.heartbeat.held() {
            let released = self.shared.runtime.block_on(self.shared.store.release(&job.lease));
            let released = matches!(released, Ok(true));
            tracing::info!(job.id = %job.lease.job, released, "gave a job back");
            job.stop();
        }
        self.wait(LAST_WORDS);
    }

    fn wait(&self, most: Duration) {
        let until = Instant::now() + most;
        let busy = || self.slots.iter().any(|slot| !slot.is_finished());
        while busy() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Shared {
    fn serve(&self, work: &mut dyn Work) {
        let mut changes = self.store.job_changes();
        while !self.stopping.load(Ordering::Relaxed) {
            if let Err(wait) = work.prepare() {
                std::thread::sleep(wait.min(UNREADY));
                continue;
            }
            changes.mark_seen();
            match self.runtime.block_on(self.claim()) {
                Ok(Some(claim)) => self.attempt(&claim, work),
                Ok(None) => self.runtime.block_on(async {
                    // Either a job of this process woke us, or it is time to look at the others'.
                    let _ = tokio::time::timeout(IDLE, changes.of_any()).await;
                }),
                Err(error) => {
                    tracing::warn!(%error, "no job could be claimed");
                    std::thread::sleep(IDLE);
                }
            }
        }
    }

    /// The next job, unless its result could not be stored.
    async fn claim(&self) -> Result<Option<Claim>, StoreError> {
        self.store.claim_if(self.lease, self.storage.is_sound()).await
    }

    fn attempt(&self, claim: &Claim, work: &mut dyn Work) {
        let lease = &claim.lease;
        let started = Instant::now();
        let parent = claim.traceparent.as_deref();
        let trace = traces::Attempt::begin(&lease.job, &claim.kind, lease.attempt, parent);
        let job = self.heartbeat.hold(lease.clone(), trace);
        let trace_id = job.trace.trace_id();
        let span = tracing::info_span!("job", job.id = %lease.job, attempt = lease.attempt, trace.id = trace_id);
        let _inside = span.enter();
        tracing::info!(kind = %claim.kind, "job started");
        let fail_points = FailPoints::of(lease.attempt, &claim.document);
        fail_points.pass_by("claim:after", &|| job.is_cancelled());
        let folder = self.store.attempt_folder(&lease.job, lease.attempt);
        let (mut effort, mut until) = (Effort::default(), None);
        let made = make(claim, &folder, &job, work);
        let worked = started.elapsed();
        let made = made.and_then(|finished| {
            job.trace.phase("publish");
            (effort, until) = (finished.effort.clone(), finished.until);
            Publication::read(finished)
        });
        if let Err(error) = remove_attempt(&folder) {
            tracing::warn!(%error, "the files of an attempt were left to the next start");
        }
        let publisher = Publisher {
            store: self.store.of_tenant(&claim.tenant),
            runtime: self.runtime.clone(),
            job: job.clone(),
            fail_points,
            patience: self.lease,
        };
        let ended = made.and_then(|publication| publisher.publish(publication, until));
        let status = self.conclude(lease, &job, ended);
        self.heartbeat.unregister(lease);
        job.trace.ended(status);
        let took = started.elapsed();
        metrics::attempt_ended(&claim.kind, status, took);
        if status == "successful" {
            let method = effort.method.as_deref().unwrap_or("none");
            metrics::job_solved(method, effort.unknowns, effort.iterations, took);
        }
        let (work_ms, duration_ms) = (worked.as_secs_f64() * 1e3, took.as_secs_f64() * 1e3);
        tracing::info!(status, work_ms, duration_ms, "job ended");
    }

    /// Writes down how an attempt ended, and returns a word for it.
    fn conclude(
        &self,
        lease: &Lease,
        job: &RunningJob,
        ended: Result<bool, Failure>,
    ) -> &'static str {
        let (status, written) = match ended {
            Ok(true) => return "successful",
            Ok(false) => return self.not_ours(lease, "fenced"),
            Err(_) if job.is_cancelled() => return self.not_ours(lease, "stopped"),
            Err(Failure::Cancelled) => {
                let error = json!({
                    "type": ErrorCode::Cancelled,
                    "class": "cancelled",
                    "detail": "the work was stopped",
                });
                ("failed", self.runtime.block_on(self.store.fail(lease, &error.to_string())))
            }
            Err(Failure::Permanent(error)) => {
                tracing::info!(%error, "job failed");
                ("failed", self.runtime.block_on(self.store.fail(lease, &error.to_string())))
            }
            Err(Failure::Storage { mut error, reason }) => {
                tracing::error!(%reason, "the storage failed an attempt");
                error["attempts"] = self.attempts.into();
                self.runtime.block_on(self.storage.doubt());
                // Storage that failed is given time, as much as a result waits for it.
                ("lost", self.lose(lease, self.lease, &error.to_string()))
            }
            Err(Failure::Lost(how)) => {
                tracing::error!(%how, "an attempt was lost");
                metrics::attempt_lost("process");
                let error = worker_lost(self.attempts, Some(&how));
                ("lost", self.lose(lease, PAUSE_AFTER_LOSS, &error))
            }
        };
        match written {
            Ok(true) => status,
            Ok(false) => self.not_ours(lease, "fenced"),
            Err(error) => {
                // The lease runs out, and another attempt follows.
                tracing::error!(%error, "how the job ended could not be written down");
                "unwritten"
            }
        }
    }

    /// The word for an attempt whose job is not its own any more: another one where the job was dismissed or erased.
    fn not_ours(&self, lease: &Lease, otherwise: &'static str) -> &'static str {
        match self.runtime.block_on(self.store.is_dismissed(&lease.job)) {
            Ok(true) => "dismissed",
            Ok(false) => otherwise,
            Err(error) => {
                tracing::warn!(%error, "why a job was not ours any more could not be told");
                otherwise
            }
        }
    }

    fn lose(&self, lease: &Lease, pause: Duration, error: &str) -> Result<bool, StoreError> {
        self.runtime.block_on(self.store.lose(lease, self.attempts, pause, error))
    }
}

/// The work. A panic on this side of it is a bug of ours and costs no slot.
fn make(
    claim: &Claim,
    folder: &Path,
    job: &RunningJob,
    work: &mut dyn Work,
) -> Result<Finished, Failure> {
    // Nothing is made below a data folder that is not mounted.
    if let Some(temporary) = folder.ancestors().nth(2) {
        std::fs::metadata(temporary)?;
    }
    std::fs::create_dir_all(folder)?;
    let made = catch_unwind(AssertUnwindSafe(|| work.work(claim, folder, job)));
    made.unwrap_or_else(|panic| {
        let words = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied());
        tracing::error!(reason = words.unwrap_or("unknown"), "a job panicked");
        Err(Failure::Permanent(broke_off(ErrorClass::Numerical)))
    })
}

/// Removes the folder of an attempt, and that of its job when it was the only one.
fn remove_attempt(folder: &Path) -> std::io::Result<()> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    if let Some(job) = folder.parent() {
        // Another attempt of the same job may have files here.
        let _ = std::fs::remove_dir(job);
    }
    Ok(())
}
