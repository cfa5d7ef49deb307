//! Worker slots: what becomes of jobs that panic, are dismissed, or lose their storage.

use std::path::Path;
use std::time::Duration;

use facies::config::Config;
use facies::schema::job::JobStatus;
use facies::store::{Claim, JobRow, Store};
use facies::worker::process::protocol::Effort;
use facies::worker::slots::Workers;
use facies::worker::work::{Failure, Finished, FinishedFile, Work};
use mechanics::progress::Progress;
use tempfile::TempDir;

use crate::rows::{job, new_job, store};

const LONG: Duration = Duration::from_secs(60);

/// Work that does what the document of its job says.
struct Scripted {
    storage_faults: usize,
}

impl Work for Scripted {
    fn work(
        &mut self,
        claim: &Claim,
        folder: &Path,
        progress: &dyn Progress,
    ) -> Result<Finished, Failure> {
        match claim.document.as_str() {
            "panic" => panic!("a bug"),
            "stored at last" if self.storage_faults < 2 => {
                self.storage_faults += 1;
                Err(Failure::of_results("disk full"))
            }
            "never stored" => Err(Failure::of_results("disk full")),
            "until stopped" => {
                while !progress.is_cancelled() {
                    std::thread::yield_now();
                }
                Err(Failure::Cancelled)
            }
            _ => {
                let path = folder.join("result.json");
                std::fs::write(&path, claim.lease.attempt.to_string())?;
                let file = FinishedFile {
                    name: "result.json".into(),
                    media_type: "application/json".into(),
                    path,
                };
                let (files, meshes) = (vec![file], Vec::new());
                Ok(Finished {
                    result: "{}".into(),
                    files,
                    meshes,
                    effort: Effort::default(),
                    until: None,
                })
            }
        }
    }
}

/// A store with one worker slot.
struct Slot {
    folder: TempDir,
    store: Store,
    workers: Workers,
}

async fn slot() -> Slot {
    slot_with_lease("3").await
}

async fn slot_with_lease(lease_s: &str) -> Slot {
    let (folder, store) = store().await;
    let settings = [
        ("workers", "1"),
        ("lease-s", lease_s),
        ("heartbeat-s", "0.1"),
        ("free-space-floor-mib", "0"),
    ];
    let config = Config::new(|name| {
        let found = settings.iter().find(|(key, _)| *key == name);
        found.map(|(_, value)| (*value).to_owned())
    });
    let work = || -> Box<dyn Work> { Box::new(Scripted { storage_faults: 0 }) };
    let runtime = tokio::runtime::Handle::current();
    let workers = Workers::start(store.clone(), &config.unwrap(), &work, runtime).unwrap();
    Slot { folder, store, workers }
}

impl Slot {
    async fn accept(&self, script: &str) -> String {
        let hash = uuid::Uuid::now_v7().to_string();
        let job = new_job(script, &hash);
        self.store.enqueue(&job, 100).await.unwrap();
        job.id
    }

    /// The job as soon as it is as wanted; a job that never comes to that fails the test instead of holding it up.
    async fn reaches(&self, id: &str, wanted: impl Fn(&JobRow) -> bool) -> JobRow {
        let reached = tokio::time::timeout(Duration::from_secs(60), self.watch(id, wanted));
        reached.await.expect("a job comes to what is wanted of it within a minute")
    }

    async fn watch(&self, id: &str, wanted: impl Fn(&JobRow) -> bool) -> JobRow {
        let mut changes = self.store.job_changes();
        loop {
            changes.mark_seen();
            let job = job(&self.store, id).await;
            if wanted(&job) {
                return job;
            }
            changes.of(id).await.unwrap();
        }
    }

    async fn starts(&self, id: &str) -> JobRow {
        self.reaches(id, |job| job.status == JobStatus::Running).await
    }

    async fn ends(&self, id: &str) -> JobRow {
        self.reaches(id, |job| job.status.is_terminal()).await
    }

    async fn stop(self, grace: Duration) -> (TempDir, Store) {
        let workers = self.workers;
        let stopped = tokio::task::spawn_blocking(move || workers.stop(grace));
        stopped.await.unwrap();
        (self.folder, self.store)
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_panics_fails_as_internal_and_the_slot_works_on() {
    let slot = slot().await;
    let bad = slot.accept("panic").await;
    let good = slot.accept("good").await;
    let ended = slot.ends(&bad).await;
    assert_eq!(ended.status, JobStatus::Failed);
    // The same job would panic again: it is no lost job that might be tried once more.
    let error = ended.error.unwrap();
    assert!(error.contains("\"type\":\"internal\""), "{error}");
    assert!(error.contains("\"class\":\"numerical\""), "{error}");
    let ended = slot.ends(&good).await;
    assert_eq!(ended.status, JobStatus::Successful);
    let (folder, _store) = slot.stop(LONG).await;
    let left = std::fs::read_dir(folder.path().join("tmp")).unwrap();
    assert_eq!(left.count(), 0, "the folders of the attempts are gone");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_fault_of_the_storage_is_tried_again_until_the_attempts_are_used_up() {
    let slot = slot_with_lease("1").await;
    let id = slot.accept("stored at last").await;
    let ended = slot.ends(&id).await;
    // A lease after the first loss, two after the second.
    assert!(ended.finished.unwrap() - ended.started.unwrap() >= 3000, "the storage has time");
    let told = (ended.status, ended.attempt);
    assert_eq!(told, (JobStatus::Successful, 3));
    let id = slot.accept("never stored").await;
    let ended = slot.ends(&id).await;
    assert_eq!((ended.status, ended.attempt), (JobStatus::Failed, 3));
    assert!(ended.error.unwrap().contains("\"type\":\"storage\""));
    slot.stop(LONG).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dismissed_job_stops_its_solver_and_frees_the_slot() {
    let slot = slot().await;
    let id = slot.accept("until stopped").await;
    slot.starts(&id).await;
    slot.store.dismiss(&id).await.unwrap();
    let next = slot.accept("good").await;
    let ended = slot.ends(&next).await;
    assert_eq!(ended.status, JobStatus::Successful);
    assert_eq!(job(&slot.store, &id).await.status, JobStatus::Dismissed);
    slot.stop(LONG).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_long_job_keeps_its_lease() {
    let slot = slot().await;
    let id = slot.accept("until stopped").await;
    let first = slot.starts(&id).await;
    // Two leases later by the clock of the database.
    let later = slot.reaches(&id, |job| job.updated > first.updated + 6000).await;
    assert_eq!((later.status, later.attempt), (JobStatus::Running, 1));
    slot.store.dismiss(&id).await.unwrap();
    slot.stop(LONG).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_that_stops_gives_its_job_back() {
    let slot = slot().await;
    let id = slot.accept("until stopped").await;
    slot.starts(&id).await;
    let (_folder, store) = slot.stop(Duration::ZERO).await;
    let row = job(&store, &id).await;
    assert_eq!((row.status, row.attempt), (JobStatus::Accepted, 1));
}
