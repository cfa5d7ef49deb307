//! Cases whose mesh a job makes: the jobs on them wait for it, go on with it, and fail with it.

use std::time::Instant;

use facies::schema::job::JobStatus;
use facies::store::{
    AddedCase, Change, Dismissal, Enqueued, JobRow, MeshedCase, NewCase, NewJob, Published, Store,
};
use serde_json::{Value, json};

use crate::deployments::Deployment;
use crate::rows::{LEASE, blob_count, enqueue, file, job, mesh, new_job};
use crate::store::made::made;
use crate::support::trials::trials;

trials! {
    on_both {
        a_job_on_a_case_that_is_meshed_waits_and_is_claimed_with_the_case_once_it_is_there
        a_meshing_that_fails_takes_those_with_it_that_wait_for_it
        a_meshing_that_is_dismissed_takes_those_with_it_that_wait_for_it
        a_meshing_that_was_lost_and_is_tried_again_has_its_jobs_wait_again
        a_case_that_is_erased_takes_its_meshing_and_all_that_waits
        a_case_that_is_erased_while_its_mesh_is_published_and_a_job_is_accepted_leaves_nothing
        a_full_queue_stores_no_case_to_be_meshed
        thousands_that_wait_for_a_mesh_hold_up_no_claim
        a_place_in_the_queue_does_not_count_those_that_wait_for_a_mesh
    }
}

const DOCUMENT: &str = r#"{"meshing":{"scan":"scan"}}"#;
const WHOLE: &str = r#"{"volume":"made"}"#;
/// As the service queues what waits.
const WAITING: &str = r#"{"predict":{"case":null,"plan":{}}}"#;

fn new_case() -> NewCase {
    let id = uuid::Uuid::now_v7().to_string();
    let scan = mesh("scan", "");
    let meshing = NewJob {
        kind: "mesh",
        case_id: Some(id.clone()),
        mesh_ids: vec![scan.id.clone()],
        ..new_job("{}", &format!("meshing of {id}"))
    };
    NewCase {
        id,
        document: DOCUMENT.into(),
        report: "null".into(),
        tags: Vec::new(),
        mesh_ids: vec![scan.id.clone()],
        meshes: vec![facies::store::NewMesh { standalone: false, ..scan }],
        meshing: Some(meshing),
    }
}

/// A case that is being meshed, and the job that does it.
async fn case(store: &Store) -> (String, String) {
    let case = new_case();
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    (case.id, case.meshing.unwrap().id)
}

fn waiting(case: &str, meshing: &str, hash: &str) -> NewJob {
    let (case_id, waits_for) = (Some(case.to_owned()), Some(meshing.to_owned()));
    NewJob { case_id, waits_for, ..new_job(WAITING, hash) }
}

async fn waits(store: &Store, case: &str, meshing: &str, hash: &str) -> JobRow {
    let new = waiting(case, meshing, hash);
    assert_eq!(store.enqueue(&new, 100_000).await.unwrap(), Enqueued::Accepted);
    job(store, &new.id).await
}

fn error_of(job: &JobRow) -> Value {
    serde_json::from_str(job.error.as_deref().unwrap()).unwrap()
}

async fn a_job_on_a_case_that_is_meshed_waits_and_is_claimed_with_the_case_once_it_is_there(
    on: Deployment,
) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    let waits = waits(&store, &case, &meshing, "a").await;
    assert_eq!((waits.status, waits.queue_position), (JobStatus::Accepted, None));
    assert_eq!(waits.waits_for.as_deref(), Some(meshing.as_str()));
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.job, meshing);
    assert!(store.claim(LEASE).await.unwrap().is_none(), "its case has no mesh");

    let (made, files) = ([made("volume")], [file("result")]);
    let meshed = MeshedCase {
        document: WHOLE.into(),
        report: r#"{"nodes":4}"#.into(),
        mesh_ids: vec![made[0].mesh.id.clone()],
    };
    let published = Published { result: "{}", files: &files, meshes: &made, case: Some(&meshed) };
    assert!(store.publish(&lease, published).await.unwrap());
    let row = store.case(&case).await.unwrap().unwrap();
    assert_eq!(
        (row.document.as_str(), row.report.as_str(), row.version),
        (WHOLE, r#"{"nodes":4}"#, 2)
    );
    assert_eq!(row.meshing.unwrap().status, Some(JobStatus::Successful));

    let claim = store.claim(LEASE).await.unwrap().unwrap();
    assert_eq!(claim.lease.job, waits.id);
    let document: Value = serde_json::from_str(&claim.document).unwrap();
    assert_eq!(document, json!({"predict": {"case": {"volume": "made"}, "plan": {}}}));
    let kept = store.job_document(&waits.id).await.unwrap().unwrap();
    assert_eq!(serde_json::from_str::<Value>(&kept).unwrap(), document, "and so it is kept");
    // Who comes now has nothing to wait for.
    let late = self::waits(&store, &case, &meshing, "b").await;
    assert_eq!((late.waits_for, late.queue_position), (None, Some(0)));

    // The job may go, and what it made stays with the case.
    assert_eq!(store.dismiss(&meshing).await.unwrap(), Dismissal::Removed);
    assert!(store.mesh(&made[0].mesh.id).await.unwrap().is_some());
    assert_eq!(store.delete_case(&case, Some(2)).await.unwrap(), Change::Done);
    assert!(store.mesh(&made[0].mesh.id).await.unwrap().is_none());
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_meshing_that_fails_takes_those_with_it_that_wait_for_it(on: Deployment) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    let first = waits(&store, &case, &meshing, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let error = json!({"type": "no-tissue", "class": "input", "detail": "nothing there"});
    assert!(store.fail(&lease, &error.to_string()).await.unwrap());
    let failed = job(&store, &first.id).await;
    assert_eq!(failed.status, JobStatus::Failed);
    let told = error_of(&failed);
    assert_eq!((&told["type"], &told["class"]), (&json!("case-not-ready"), &json!("input")));
    assert!(told["detail"].as_str().unwrap().contains("no-tissue: nothing there"), "{told}");
    assert_eq!(told["meshing"], json!({"job": meshing, "error": error}));
    let events = store.job_events(&first.id, 0).await.unwrap().unwrap();
    assert_eq!(events.last().unwrap().status, JobStatus::Failed);
    // One that comes later, having seen the case before, is not accepted.
    let late = waiting(&case, &meshing, "b");
    assert_eq!(store.enqueue(&late, 100).await.unwrap(), Enqueued::NotMeshed);
}

async fn a_meshing_that_is_dismissed_takes_those_with_it_that_wait_for_it(on: Deployment) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    let first = waits(&store, &case, &meshing, "a").await;
    assert_eq!(store.dismiss(&meshing).await.unwrap(), Dismissal::Dismissed);
    let told = error_of(&job(&store, &first.id).await);
    assert_eq!((&told["type"], &told["class"]), (&json!("case-not-ready"), &json!("cancelled")));
    assert!(told["detail"].as_str().unwrap().contains("dismissed"), "{told}");
    assert_eq!(told["meshing"]["error"]["type"], "cancelled", "as the case itself has it");
    // Another host that still works on it changes nothing, and the case stays as it was posted.
    let row = store.case(&case).await.unwrap().unwrap();
    assert_eq!((row.document.as_str(), row.version), (DOCUMENT, 1));
    assert_eq!(store.dismiss(&meshing).await.unwrap(), Dismissal::Removed);
    let meshing = store.case(&case).await.unwrap().unwrap().meshing.unwrap();
    assert_eq!((meshing.status, meshing.error), (None, None));
}

async fn a_meshing_that_was_lost_and_is_tried_again_has_its_jobs_wait_again(on: Deployment) {
    const LOST: &str = r#"{"type":"worker-lost","class":"infrastructure","detail":"twice"}"#;
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    let first = waits(&store, &case, &meshing, "a").await;
    for status in [JobStatus::Accepted, JobStatus::Failed] {
        store.claim(LEASE).await.unwrap().unwrap();
        on.execute("UPDATE jobs SET lease_expires = 1").await;
        store.reap(2, LOST).await.unwrap();
        assert_eq!(job(&store, &first.id).await.status, status);
    }
    let lost: Vec<String> =
        store.lost_jobs(None, 9).await.unwrap().into_iter().map(|row| row.id).collect();
    assert_eq!(lost, [meshing.as_str()], "the job that waits is lost with it and not by itself");
    assert!(!store.requeue(&first.id).await.unwrap());
    assert!(store.requeue(&meshing).await.unwrap());
    let again = job(&store, &first.id).await;
    assert_eq!((again.status, again.error), (JobStatus::Accepted, None));
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().lease.job, meshing);
    assert!(store.claim(LEASE).await.unwrap().is_none());
}

async fn a_case_that_is_erased_takes_its_meshing_and_all_that_waits(on: Deployment) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    let first = waits(&store, &case, &meshing, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(store.delete_case(&case, Some(1)).await.unwrap(), Change::Done);
    assert!(!store.holds(&lease).await.unwrap(), "who meshes it finds it gone");
    for id in [&case, &meshing, &first.id] {
        assert!(store.erased(id).await.unwrap().is_some());
    }
    let made = [made("late")];
    let published = Published { result: "{}", files: &[], meshes: &made, case: None };
    assert!(!store.publish(&lease, published).await.unwrap());
    assert_eq!(blob_count(&store).await, 0, "the scan went as well");
}

async fn a_case_that_is_erased_while_its_mesh_is_published_and_a_job_is_accepted_leaves_nothing(
    on: Deployment,
) {
    let store = on.open().await;
    let (second, third) = (on.again(&store).await, on.again(&store).await);
    for round in 0..20 {
        let (case, meshing) = case(&store).await;
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        let made = [made("volume")];
        let meshed = MeshedCase {
            document: WHOLE.into(),
            report: "null".into(),
            mesh_ids: vec![made[0].mesh.id.clone()],
        };
        let published = Published { result: "{}", files: &[], meshes: &made, case: Some(&meshed) };
        let late = waiting(&case, &meshing, &format!("round {round}"));
        let (published, erased, accepted) = tokio::join!(
            store.publish(&lease, published),
            second.delete_case(&case, None),
            third.enqueue(&late, 100),
        );
        // None of them waits for another in a circle, which PostgreSQL would end with an error.
        published.unwrap();
        assert_eq!(erased.unwrap(), Change::Done);
        accepted.unwrap();
        assert!(store.job(&late.id).await.unwrap().is_none(), "round {round}");
        assert!(store.mesh(&made[0].mesh.id).await.unwrap().is_none(), "round {round}");
    }
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_full_queue_stores_no_case_to_be_meshed(on: Deployment) {
    let store = on.open().await;
    enqueue(&store, "a").await;
    let case = new_case();
    assert_eq!(store.add_case(&case, 1).await.unwrap(), AddedCase::QueueFull);
    assert!(store.case(&case.id).await.unwrap().is_none());
    assert_eq!(blob_count(&store).await, 0);
}

async fn thousands_that_wait_for_a_mesh_hold_up_no_claim(on: Deployment) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    waits(&store, &case, &meshing, "a").await;
    // As many as may wait, in one statement, each with its first event.
    on.execute(
        "INSERT INTO jobs (id, kind, case_id, document, spec_hash, engine, status, progress, attempt, losses, \
           claimable_from, created, updated, waits_for) \
         WITH RECURSIVE numbers (n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM numbers WHERE n < 10000) \
         SELECT 'waits ' || n, kind, case_id, document, 'waits ' || n, engine, status, 0, 0, 0, 0, 1, 1, waits_for \
         FROM numbers, jobs WHERE waits_for <> ''",
    )
    .await;
    on.execute(
        "INSERT INTO job_events (job_id, number, at, status, progress, attempt) \
         SELECT id, 1, 1, status, 0, 0 FROM jobs WHERE id LIKE 'waits %'",
    )
    .await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.job, meshing);
    let begun = Instant::now();
    for _ in 0..100 {
        assert!(store.claim(LEASE).await.unwrap().is_none());
    }
    // A pass over all of them takes some 3 ms on an idle machine.
    let each_ms = begun.elapsed().as_secs_f64() * 10.0;
    println!("a claim takes {each_ms:.2} ms");
    assert!(each_ms < 100.0, "{each_ms} ms");
    let begun = Instant::now();
    assert_eq!(store.dismiss(&meshing).await.unwrap(), Dismissal::Dismissed);
    println!("10 001 jobs fail in {:.2} s", begun.elapsed().as_secs_f64());
    let told = "SELECT COUNT(*) || '' FROM job_events WHERE status = 'failed' AND number = 2";
    assert_eq!(on.texts(told).await, ["10001"]);
    let failed = "SELECT COUNT(*) || '' FROM jobs WHERE status = 'failed'";
    assert_eq!(on.texts(failed).await, ["10001"]);
}

async fn a_place_in_the_queue_does_not_count_those_that_wait_for_a_mesh(on: Deployment) {
    let store = on.open().await;
    let (case, meshing) = case(&store).await;
    waits(&store, &case, &meshing, "a").await;
    let next = enqueue(&store, "b").await;
    assert_eq!(job(&store, &next).await.queue_position, Some(1), "behind the meshing alone");
    let listed = store.jobs(&facies::store::JobFilter { limit: 9, ..Default::default() }).await;
    let places: Vec<_> = listed.unwrap().into_iter().map(|row| row.queue_position).collect();
    assert_eq!(places, [Some(1), None, Some(0)]);
}
