//! Leases: every accepted job ends exactly once, whatever happens to those who work on it.

use std::path::Path;
use std::time::Duration;

use bytes::Bytes;
use facies::schema::canonical::sha256_hex;
use facies::schema::job::JobStatus;
use facies::store::{
    Claim, Dismissal, Enqueued, JobRow, NewJob, Point, PublishedFile, QueueRow, Store, StoreError,
};
use sqlx::Connection;
use tempfile::TempDir;

const LEASE: Duration = Duration::from_secs(60);

pub async fn store() -> (TempDir, Store) {
    let folder = TempDir::new().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    (folder, store)
}

/// A job of no case; its document is read by nobody or by a test's own work.
pub fn new_job(document: &str, hash: &str) -> NewJob {
    NewJob {
        id: uuid::Uuid::now_v7().to_string(),
        kind: "predict",
        case_id: None,
        shared_cases: Vec::new(),
        document: document.into(),
        spec_hash: hash.into(),
        engine: "test".into(),
        tags: vec!["a".into()],
        mesh_ids: vec![],
    }
}

async fn enqueue(store: &Store, hash: &str) -> String {
    let job = new_job("{}", hash);
    assert_eq!(store.enqueue(&job, 100).await.unwrap(), Enqueued::Accepted);
    job.id
}

pub async fn job(store: &Store, id: &str) -> JobRow {
    store.job(id).await.unwrap().unwrap()
}

/// What happens to a lease whose worker sleeps too long.
async fn let_leases_run_out(folder: &Path) {
    execute(folder, "UPDATE jobs SET lease_expires = 1").await;
}

async fn execute(folder: &Path, sql: &'static str) {
    let file = folder.join("facies.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file);
    let connected = sqlx::SqliteConnection::connect_with(&options).await;
    let mut connection = connected.unwrap();
    sqlx::query(sql).execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}

fn file(content: &'static str) -> PublishedFile {
    let bytes = Bytes::from_static(content.as_bytes());
    PublishedFile {
        name: "result.json".into(),
        media_type: "application/json".into(),
        sha256: sha256_hex(&bytes),
        bytes,
    }
}

fn blob_count(folder: &Path) -> usize {
    let folders = std::fs::read_dir(folder.join("blobs")).unwrap();
    folders.map(|entry| std::fs::read_dir(entry.unwrap().path()).unwrap().count()).sum()
}

#[tokio::test]
async fn a_job_is_claimed_by_one_worker_only() {
    let (_folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let other = store.again().await.unwrap();
    let (first, second) = tokio::join!(store.claim(LEASE), other.claim(LEASE));
    let claims: Vec<Claim> = [first, second].into_iter().filter_map(Result::unwrap).collect();
    assert_eq!(claims.len(), 1);
    assert_eq!(claims[0].lease.job, id);
    assert_eq!(job(&store, &id).await.attempt, 1);
}

#[tokio::test]
async fn a_worker_that_was_thought_dead_publishes_nothing() {
    let (folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let zombie = store.claim(LEASE).await.unwrap().unwrap().lease;
    let_leases_run_out(folder.path()).await;
    let reaped = store.reap(3, "{}").await.unwrap();
    assert!(reaped.len() == 1 && reaped[0].accepted_again);

    let other = store.again().await.unwrap();
    let lease = other.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.attempt, 2);
    assert_ne!(lease.token, zombie.token);

    let late = [file("zombie")];
    assert!(!store.publish(&zombie, "\"zombie\"", &late).await.unwrap());
    assert!(!store.fail(&zombie, "{}").await.unwrap());
    assert!(!store.release(&zombie).await.unwrap());
    assert!(!store.lose(&zombie, 3, "{}").await.unwrap());
    let point = Point::default();
    assert!(!store.renew(&zombie, LEASE, &point).await.unwrap());
    assert_eq!(job(&store, &id).await.status, JobStatus::Running);
    assert_eq!(blob_count(folder.path()), 0, "its files are gone");

    let second = [file("second")];
    assert!(other.publish(&lease, "\"second\"", &second).await.unwrap());
    let ended = job(&store, &id).await;
    assert_eq!(ended.status, JobStatus::Successful);
    assert_eq!(ended.result.as_deref(), Some("\"second\""));
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "second");
}

#[tokio::test]
async fn a_job_that_loses_its_worker_three_times_fails_as_worker_lost() {
    const LOST: &str = r#"{"type":"worker-lost"}"#;
    let (folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    for attempt in 1..=3 {
        let claim = store.claim(LEASE).await.unwrap().unwrap();
        assert_eq!(claim.lease.attempt, attempt);
        let reaped = store.reap(3, LOST).await.unwrap();
        assert!(reaped.is_empty(), "the lease holds");
        let_leases_run_out(folder.path()).await;
        store.reap(3, LOST).await.unwrap();
    }
    let ended = job(&store, &id).await;
    assert_eq!(ended.status, JobStatus::Failed);
    assert_eq!(ended.error.as_deref(), Some(LOST));
    assert!(ended.finished.is_some());
    assert!(store.claim(LEASE).await.unwrap().is_none());
}

#[tokio::test]
async fn a_job_given_back_by_a_stopping_worker_loses_no_attempt() {
    let (_folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    for attempt in 1..=5 {
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert_eq!(lease.attempt, attempt);
        assert!(store.release(&lease).await.unwrap());
    }
    assert_eq!(job(&store, &id).await.status, JobStatus::Accepted);
}

#[tokio::test]
async fn a_result_that_comes_after_the_dismissal_is_dropped() {
    let (folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Dismissed);
    assert!(!store.holds(&lease).await.unwrap());
    let late = [file("late")];
    assert!(!store.publish(&lease, "{}", &late).await.unwrap());
    assert_eq!(job(&store, &id).await.status, JobStatus::Dismissed);
    assert_eq!(blob_count(folder.path()), 0);
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Removed);
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::NotFound);
    assert!(store.job(&id).await.unwrap().is_none());
}

#[tokio::test]
async fn the_same_inputs_are_the_same_job() {
    let (_folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let again = new_job("{}", "a");
    let enqueued = store.enqueue(&again, 100).await.unwrap();
    assert_eq!(enqueued, Enqueued::Known(id));
    let other = new_job("{}", "b");
    assert_eq!(store.enqueue(&other, 1).await.unwrap(), Enqueued::QueueFull);
}

#[tokio::test]
async fn the_queue_is_counted_with_the_age_of_its_oldest_job() {
    let (folder, store) = store().await;
    assert_eq!(store.queue().await.unwrap(), QueueRow::default());
    for hash in ["a", "b", "c"] {
        enqueue(&store, hash).await;
    }
    store.claim(LEASE).await.unwrap().unwrap();
    execute(folder.path(), "UPDATE jobs SET created = created - 5000 WHERE spec_hash = 'b'").await;
    let queue = store.queue().await.unwrap();
    assert_eq!((queue.waiting, queue.running), (2, 1));
    assert!((5000..65_000).contains(&queue.oldest_ms), "{queue:?}");
}

#[tokio::test]
async fn progress_never_falls() {
    let (_folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    for (progress, shown) in [(30, 30), (10, 30), (31, 31)] {
        let point = Point { phase: Some("solve"), progress, ..Point::default() };
        assert!(store.renew(&lease, LEASE, &point).await.unwrap());
        assert_eq!(job(&store, &id).await.progress, shown);
    }
}

#[tokio::test]
async fn a_start_removes_what_a_dead_process_left() {
    let (folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let kept = [file("kept")];
    assert!(store.publish(&lease, "{}", &kept).await.unwrap());
    let attempt = store.attempt_folder("job", 1);
    std::fs::create_dir_all(&attempt).unwrap();
    std::fs::write(attempt.join("skin.vtp"), "half").unwrap();
    let orphan = "ab".repeat(32);
    let blobs = folder.path().join("blobs/ab");
    std::fs::create_dir_all(&blobs).unwrap();
    std::fs::write(blobs.join(&orphan), "x").unwrap();
    std::fs::write(blobs.join(format!("{orphan}#1")), "x").unwrap();

    let swept = store.sweep().await.unwrap();
    assert_eq!((swept.blobs, swept.temporary), (1, 2));
    assert!(!attempt.exists());
    assert_eq!(blob_count(folder.path()), 1);
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "kept");
}

#[tokio::test]
async fn a_blob_that_changed_on_disk_is_never_served() {
    let (folder, store) = store().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let right = [file("right")];
    assert!(store.publish(&lease, "{}", &right).await.unwrap());
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    let blobs = folder.path().join("blobs").join(&row.blob[..2]);
    std::fs::write(blobs.join(&row.blob), "wrong").unwrap();
    let error = store.read_blob(&row.blob).await.unwrap_err();
    assert!(matches!(error, StoreError::Integrity { .. }), "{error}");
}

#[tokio::test]
async fn a_program_older_than_its_database_refuses_to_start() {
    let folder = TempDir::new().unwrap();
    Store::open(folder.path()).await.unwrap().close().await;
    execute(
        folder.path(),
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
         VALUES (9999, 'later', 1, x'00', 1)",
    )
    .await;
    let error = Store::open(folder.path()).await.err().unwrap();
    let too_new = matches!(error, StoreError::SchemaTooNew { found: 9999, .. });
    assert!(too_new, "{error}");
}

#[tokio::test]
async fn a_data_folder_serves_one_process() {
    let (folder, _store) = store().await;
    let error = Store::open(folder.path()).await.err().unwrap();
    assert!(matches!(error, StoreError::InUse), "{error}");
}
