//! Jobs that failed through no fault of their own, and how they are told from the others.

use facies::store::Store;
use serde_json::json;

use crate::deployments::Deployment;
use crate::rows::{LEASE, PAUSE, enqueue};
use crate::support::trials::trials;

trials! {
    on_both {
        what_an_error_says_of_itself_tells_whether_its_job_was_lost
        who_loses_its_worker_too_often_is_lost
        what_was_lost_before_errors_had_classes_is_still_lost
    }
}

/// The class of an error is a member of it, however it is written and whatever else it tells.
const LOST: &str = r#"{ "type": "storage", "class": "infrastructure", "detail": "no disk" }"#;
const NOT_LOST: &str = r#"{"class":"input","detail":"no","of":{"class":"infrastructure"}}"#;

/// Fails a job for good; its id.
async fn failed(store: &Store, hash: &str, error: &str) -> String {
    let id = enqueue(store, hash).await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.job, id);
    assert!(store.fail(&lease, error).await.unwrap());
    id
}

async fn lost(store: &Store) -> Vec<String> {
    let rows = store.lost_jobs(None, 9).await.unwrap();
    rows.into_iter().map(|row| row.id).collect()
}

async fn what_an_error_says_of_itself_tells_whether_its_job_was_lost(on: Deployment) {
    let store = on.open().await;
    let ours = failed(&store, "a", LOST).await;
    let theirs = failed(&store, "b", NOT_LOST).await;
    assert_eq!(lost(&store).await, [ours.as_str()]);
    assert!(!store.requeue(&theirs).await.unwrap());
    assert!(store.requeue(&ours).await.unwrap());
    assert!(lost(&store).await.is_empty(), "it is accepted again");
    let classes = "SELECT COUNT(*) || '' FROM jobs WHERE error_class = 'infrastructure'";
    assert_eq!(on.texts(classes).await, ["0"], "and its error is gone");
}

async fn who_loses_its_worker_too_often_is_lost(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    for wanted in [&[][..], std::slice::from_ref(&id)] {
        store.claim(LEASE).await.unwrap().unwrap();
        on.execute("UPDATE jobs SET lease_expires = 1").await;
        assert_eq!(store.reap(2, LOST).await.unwrap().len(), 1);
        assert_eq!(lost(&store).await, wanted);
    }
    assert!(store.requeue(&id).await.unwrap());
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 1, PAUSE, LOST).await.unwrap());
    assert_eq!(lost(&store).await, [id]);
}

/// The ninth step gave them their classes.
async fn what_was_lost_before_errors_had_classes_is_still_lost(on: Deployment) {
    let store = on.open().await;
    let error = |class: &str| json!({"type": "worker-lost", "class": class, "detail": "no \"class\":\"infrastructure\""});
    let mut jobs = Vec::new();
    for class in ["numerical", "infrastructure", "input", "budget", "cancelled"] {
        jobs.push(failed(&store, class, &error(class).to_string()).await);
    }
    enqueue(&store, "waits").await;
    const CLASSES: &str = "SELECT COALESCE(error_class, 'none') FROM jobs ORDER BY id";
    let classes = on.texts(CLASSES).await;
    assert_eq!(classes[..2], ["numerical", "infrastructure"]);
    store.close().await;
    drop(store);
    on.execute(
        "ALTER TABLE job_tags DROP COLUMN number; DROP VIEW age_clock; DROP TABLE seen_clock; DROP TABLE identity; DROP TABLE cohort_models; DROP TABLE cohort_left; DROP TABLE cohort_members; DROP TABLE cohorts; \
         DROP INDEX cases_by_meshing; ALTER TABLE cases DROP COLUMN meshing; DROP INDEX jobs_by_tenant; \
         ALTER TABLE jobs DROP COLUMN waits_for; CREATE INDEX jobs_by_tenant ON jobs (tenant, status, priority, id); \
         DROP INDEX jobs_by_rows; ALTER TABLE jobs DROP COLUMN truths; ALTER TABLE jobs DROP COLUMN rows_key; ALTER TABLE deeds DROP COLUMN alive; DROP INDEX jobs_by_age; ALTER TABLE jobs DROP COLUMN numerics; \
         ALTER TABLE idempotency_keys DROP COLUMN found; DROP TABLE made_meshes; DROP INDEX jobs_by_error_class; ALTER TABLE jobs DROP COLUMN error_class; \
         DELETE FROM _sqlx_migrations WHERE version >= 9",
    )
    .await;
    let migrated = Store::migrate(&on.places).await.unwrap();
    assert_eq!(migrated.from, 8);
    assert_eq!(on.texts(CLASSES).await, classes);
    assert_eq!(lost(&on.open().await).await, [jobs[1].as_str()]);
}
