//! Worker threads: claim a job, work, publish. Each slot is a thread with a thread pool of its own, so
//! that numerics never run where requests are answered.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use bytes::Bytes;
use serde_json::json;
use tokio::runtime::Handle;

use super::heartbeat::{Heartbeat, RunningJob};
use crate::config::Config;
use crate::prediction::Progress;
use crate::schema::canonical::sha256_hex;
use crate::store::{Claim, Lease, PublishedFile, Store, StoreError};

/// How long an idle worker waits before it looks for jobs that another process has accepted.
const IDLE: Duration = Duration::from_secs(1);
/// How long a solver that was told to stop may take before the process ends without it.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// Between two tries to publish while the database is busy.
const PUBLISH_PAUSE: Duration = Duration::from_millis(200);

/// What an attempt made: the manifest, and files in the folder it was given.
pub struct Finished {
    /// JSON.
    pub result: String,
    pub files: Vec<FinishedFile>,
}

/// A file by its name in the folder of the attempt.
pub struct FinishedFile {
    pub name: String,
    pub media_type: String,
    pub path: PathBuf,
}

/// Why an attempt made nothing.
#[derive(Debug)]
pub enum Failure {
    /// It was told to stop.
    Cancelled,
    /// The job's own fault, never tried again: JSON with `type` and `detail`.
    Permanent(serde_json::Value),
    /// The storage's fault: tried again.
    Storage(String),
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Failure::Storage(error.to_string())
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Failure::Storage(error.to_string())
    }
}

/// From a claimed job to files in a folder. A later version may do it in a process of its own.
pub trait Work: Send + Sync {
    fn work(
        &self,
        claim: &Claim,
        folder: &Path,
        progress: &dyn Progress,
    ) -> Result<Finished, Failure>;
}

/// The worker slots of this process.
pub struct Workers {
    shared: Arc<Shared>,
    slots: Vec<JoinHandle<()>>,
}

struct Shared {
    store: Store,
    heartbeat: Heartbeat,
    runtime: Handle,
    work: Arc<dyn Work>,
    lease: Duration,
    attempts: u32,
    stopping: AtomicBool,
}

impl Workers {
    /// Starts the slots. `runtime` answers their questions to the store.
    pub fn start(
        store: Store,
        config: &Config,
        work: Arc<dyn Work>,
        runtime: Handle,
    ) -> Result<Workers, StoreError> {
        let shared = Arc::new(Shared {
            heartbeat: Heartbeat::start(store.clone(), config)?,
            store,
            runtime,
            work,
            lease: config.lease,
            attempts: config.attempts,
            stopping: AtomicBool::new(false),
        });
        let mut slots = Vec::with_capacity(config.workers);
        for slot in 0..config.workers {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(config.threads_per_job)
                .thread_name(move |thread| format!("solver-{slot}-{thread}"))
                .build()
                .map_err(std::io::Error::other)?;
            let shared = shared.clone();
            let thread = std::thread::Builder::new()
                .name(format!("worker-{slot}"))
                .spawn(move || shared.serve(&pool))?;
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
            tracing::info!(job.id = %job.lease.job, released = released.is_ok(), "gave a job back");
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
    fn serve(&self, pool: &rayon::ThreadPool) {
        let mut changes = self.store.job_changes();
        while !self.stopping.load(Ordering::Relaxed) {
            changes.mark_unchanged();
            match self.runtime.block_on(self.store.claim(self.lease)) {
                Ok(Some(claim)) => self.attempt(&claim, pool),
                Ok(None) => self.runtime.block_on(async {
                    // Either a job of this process woke us, or it is time to look at the others'.
                    let _ = tokio::time::timeout(IDLE, changes.changed()).await;
                }),
                Err(error) => {
                    tracing::warn!(%error, "no job could be claimed");
                    std::thread::sleep(IDLE);
                }
            }
        }
    }

    fn attempt(&self, claim: &Claim, pool: &rayon::ThreadPool) {
        let lease = &claim.lease;
        let started = Instant::now();
        let job = self.heartbeat.hold(lease.clone());
        let span = tracing::info_span!("job", job.id = %lease.job, attempt = lease.attempt);
        let _inside = span.enter();
        tracing::info!(kind = %claim.kind, "job started");
        let folder = self.store.attempt_folder(&lease.job, lease.attempt);
        let made = self.make(claim, &folder, &job, pool).and_then(|finished| {
            let files = read_files(finished.files)?;
            Ok((finished.result, files))
        });
        if let Err(error) = remove_attempt(&folder) {
            tracing::warn!(%error, "the files of an attempt were left to the next start");
        }
        let ended = made.and_then(|(result, files)| self.publish(lease, &result, &files));
        let status = self.conclude(lease, &job, ended);
        self.heartbeat.let_go(lease);
        let duration_ms = started.elapsed().as_secs_f64() * 1e3;
        tracing::info!(status, duration_ms, "job ended");
    }

    /// The work, on the slot's thread pool. A panic is the job's own fault and costs no slot.
    fn make(
        &self,
        claim: &Claim,
        folder: &Path,
        job: &RunningJob,
        pool: &rayon::ThreadPool,
    ) -> Result<Finished, Failure> {
        std::fs::create_dir_all(folder)?;
        let work = || pool.install(|| self.work.work(claim, folder, job));
        catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
            let words = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied());
            tracing::error!(reason = words.unwrap_or("unknown"), "a job panicked");
            Err(Failure::Permanent(json!({
                "type": "internal",
                "class": "infrastructure",
                "detail": "the work broke off; the log has the details under the job's id",
            })))
        })
    }

    /// Stores the files and makes them and the manifest visible at once; false when the job is not ours.
    fn publish(
        &self,
        lease: &Lease,
        result: &str,
        files: &[PublishedFile],
    ) -> Result<bool, Failure> {
        let until = Instant::now() + self.lease;
        loop {
            let published = self.store.publish(lease, result, files);
            match self.runtime.block_on(published) {
                Err(error) if error.is_unavailable() && Instant::now() < until => {
                    tracing::warn!(%error, "the result waits for the database");
                    std::thread::sleep(PUBLISH_PAUSE);
                }
                published => return Ok(published?),
            }
        }
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
            Ok(false) => return "fenced",
            Err(_) if job.is_cancelled() => return "stopped",
            Err(Failure::Cancelled) => {
                let error = json!({
                    "type": "cancelled",
                    "class": "cancelled",
                    "detail": "the work was stopped",
                });
                ("failed", self.runtime.block_on(self.store.fail(lease, &error.to_string())))
            }
            Err(Failure::Permanent(error)) => {
                tracing::info!(%error, "job failed");
                ("failed", self.runtime.block_on(self.store.fail(lease, &error.to_string())))
            }
            Err(Failure::Storage(reason)) => {
                tracing::error!(%reason, "the storage failed an attempt");
                let error = json!({
                    "type": "storage",
                    "class": "infrastructure",
                    "detail": "the results could not be stored",
                    "attempts": self.attempts,
                });
                let error = error.to_string();
                let lost = self.store.lose(lease, self.attempts, &error);
                ("lost", self.runtime.block_on(lost))
            }
        };
        match written {
            Ok(true) => status,
            Ok(false) => "fenced",
            Err(error) => {
                // The lease runs out, and another attempt follows.
                tracing::error!(%error, "how the job ended could not be written down");
                "unwritten"
            }
        }
    }
}

fn read_files(files: Vec<FinishedFile>) -> std::io::Result<Vec<PublishedFile>> {
    let read = |file: FinishedFile| {
        let bytes = Bytes::from(std::fs::read(&file.path)?);
        let sha256 = sha256_hex(&bytes);
        Ok(PublishedFile { name: file.name, media_type: file.media_type, sha256, bytes })
    };
    files.into_iter().map(read).collect()
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
