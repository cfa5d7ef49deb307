//! Leases: every accepted job ends exactly once, whatever happens to those who work on it.

use facies::schema::job::JobStatus;
use facies::store::{Claim, Dismissal, Enqueued, JobFilter, Point, QueueRow};

use crate::deployments::Deployment;
use crate::rows::{LEASE, PAUSE, blob_count, enqueue, file, job, new_job, result};
use crate::support::trials::trials;

trials! {
    on_both {
        a_job_is_claimed_by_one_worker_only
        a_job_whose_claim_has_a_condition_stays_as_it_is_while_that_does_not_hold
        a_job_that_loses_its_worker_three_times_fails_as_worker_lost
        a_worker_that_was_thought_dead_publishes_nothing
        leases_and_pauses_outlive_no_clock_that_goes_back
        a_job_given_back_by_a_stopping_worker_loses_no_attempt
        a_result_that_comes_after_the_dismissal_is_dropped
        the_same_inputs_are_the_same_job
        the_queue_is_counted_with_the_age_of_its_oldest_job
        progress_never_falls
        lists_come_newest_first_page_by_page
    }
}

/// What happens to a lease whose worker sleeps too long.
async fn let_leases_run_out(on: &Deployment) {
    on.execute("UPDATE jobs SET lease_expires = 1").await;
}

async fn lists_come_newest_first_page_by_page(on: Deployment) {
    let store = on.open().await;
    let mut ids = Vec::new();
    for hash in ["a", "b", "c"] {
        ids.push(enqueue(&store, hash).await);
    }
    ids.reverse();
    let mut filter = JobFilter { tag: "a".into(), limit: 2, ..JobFilter::default() };
    let listed = store.jobs(&filter).await.unwrap();
    assert_eq!(listed.iter().map(|job| &job.id).collect::<Vec<_>>(), [&ids[0], &ids[1]]);
    filter.cursor = Some(ids[1].clone());
    let listed = store.jobs(&filter).await.unwrap();
    assert_eq!(listed.iter().map(|job| &job.id).collect::<Vec<_>>(), [&ids[2]]);
    filter.tag = "no such\0tag".into();
    assert!(store.jobs(&filter).await.unwrap().is_empty());
}

async fn a_job_is_claimed_by_one_worker_only(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let other = on.again(&store).await;
    let (first, second) = tokio::join!(store.claim(LEASE), other.claim(LEASE));
    let claims: Vec<Claim> = [first, second].into_iter().filter_map(Result::unwrap).collect();
    assert_eq!(claims.len(), 1);
    assert_eq!(claims[0].lease.job, id);
    assert_eq!(job(&store, &id).await.attempt, 1);
}

async fn a_job_whose_claim_has_a_condition_stays_as_it_is_while_that_does_not_hold(on: Deployment) {
    let store = on.open().await;
    let unasked = async { panic!("nobody has to know where there is no job") };
    assert!(store.claim_if(LEASE, unasked).await.unwrap().is_none());
    let id = enqueue(&store, "a").await;
    let before = job(&store, &id).await;
    assert!(store.claim_if(LEASE, async { false }).await.unwrap().is_none());
    let after = job(&store, &id).await;
    assert_eq!(
        (after.status, after.attempt, after.updated),
        (JobStatus::Accepted, 0, before.updated)
    );
    assert_eq!(store.claim_if(LEASE, async { true }).await.unwrap().unwrap().lease.job, id);
}

async fn a_worker_that_was_thought_dead_publishes_nothing(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let zombie = store.claim(LEASE).await.unwrap().unwrap().lease;
    let_leases_run_out(&on).await;
    let reaped = store.reap(3, "{}").await.unwrap();
    assert!(reaped.len() == 1 && reaped[0].accepted_again);

    let other = on.again(&store).await;
    let lease = other.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.attempt, 2);
    assert_ne!(lease.token, zombie.token);

    let late = [file("zombie")];
    assert!(!store.publish(&zombie, result("\"zombie\"", &late)).await.unwrap());
    assert!(!store.fail(&zombie, "{}").await.unwrap());
    assert!(!store.release(&zombie).await.unwrap());
    assert!(!store.lose(&zombie, 3, PAUSE, "{}").await.unwrap());
    let point = Point::default();
    assert!(!store.renew(&zombie, LEASE, &point).await.unwrap());
    assert_eq!(job(&store, &id).await.status, JobStatus::Running);
    assert_eq!(blob_count(&store).await, 0, "its files are gone");

    let second = [file("second")];
    assert!(other.publish(&lease, result("\"second\"", &second)).await.unwrap());
    let ended = job(&store, &id).await;
    assert_eq!(ended.status, JobStatus::Successful);
    assert_eq!(ended.result.as_deref(), Some("\"second\""));
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "second");
}

async fn a_job_that_loses_its_worker_three_times_fails_as_worker_lost(on: Deployment) {
    const LOST: &str = r#"{"type":"worker-lost"}"#;
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    for attempt in 1..=3 {
        let claim = store.claim(LEASE).await.unwrap().unwrap();
        assert_eq!(claim.lease.attempt, attempt);
        let reaped = store.reap(3, LOST).await.unwrap();
        assert!(reaped.is_empty(), "the lease holds");
        let_leases_run_out(&on).await;
        store.reap(3, LOST).await.unwrap();
    }
    let ended = job(&store, &id).await;
    assert_eq!(ended.status, JobStatus::Failed);
    assert_eq!(ended.error.as_deref(), Some(LOST));
    assert!(ended.finished.is_some());
    assert!(store.claim(LEASE).await.unwrap().is_none());
}

async fn leases_and_pauses_outlive_no_clock_that_goes_back(on: Deployment) {
    // Two hours, as seen from the clock of now.
    const AHEAD: i64 = 2 * 3_600_000;
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    store.claim(LEASE).await.unwrap().unwrap();
    on.execute(&format!(
        "UPDATE jobs SET lease_expires = lease_expires + {AHEAD}, heartbeat = heartbeat + {AHEAD}"
    ))
    .await;
    assert!(store.reap(3, "{}").await.unwrap().is_empty(), "the lease has its length");
    let length = LEASE.as_millis() + 1;
    on.execute(&format!("UPDATE jobs SET lease_expires = lease_expires - {length}")).await;
    assert_eq!(store.reap(3, "{}").await.unwrap().len(), 1);

    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 3, PAUSE, "{}").await.unwrap());
    on.execute(&format!(
        "UPDATE jobs SET claimable_from = claimable_from + {AHEAD}, updated = updated + {AHEAD}"
    ))
    .await;
    store.reap(3, "{}").await.unwrap();
    on.execute("UPDATE jobs SET claimable_from = claimable_from - 60000").await;
    assert_eq!(store.claim(LEASE).await.unwrap().expect("claimable").lease.job, id);
}

async fn a_job_given_back_by_a_stopping_worker_loses_no_attempt(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    for attempt in 1..=5 {
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert_eq!(lease.attempt, attempt);
        assert!(store.release(&lease).await.unwrap());
    }
    assert_eq!(job(&store, &id).await.status, JobStatus::Accepted);
}

async fn a_result_that_comes_after_the_dismissal_is_dropped(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Dismissed);
    assert!(!store.holds(&lease).await.unwrap());
    let late = [file("late")];
    assert!(!store.publish(&lease, result("{}", &late)).await.unwrap());
    assert_eq!(job(&store, &id).await.status, JobStatus::Dismissed);
    assert_eq!(blob_count(&store).await, 0);
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Removed);
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::NotFound);
    assert!(store.job(&id).await.unwrap().is_none());
}

async fn the_same_inputs_are_the_same_job(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let again = new_job("{}", "a");
    let enqueued = store.enqueue(&again, 100).await.unwrap();
    assert_eq!(enqueued, Enqueued::Known(id));
    let other = new_job("{}", "b");
    assert_eq!(store.enqueue(&other, 1).await.unwrap(), Enqueued::QueueFull);
}

async fn the_queue_is_counted_with_the_age_of_its_oldest_job(on: Deployment) {
    let store = on.open().await;
    assert_eq!(store.queue().await.unwrap(), QueueRow::default());
    for hash in ["a", "b", "c"] {
        enqueue(&store, hash).await;
    }
    store.claim(LEASE).await.unwrap().unwrap();
    on.execute("UPDATE jobs SET created = created - 5000 WHERE spec_hash = 'b'").await;
    let queue = store.queue().await.unwrap();
    assert_eq!((queue.waiting, queue.running), (2, 1));
    assert!((5000..65_000).contains(&queue.oldest_ms), "{queue:?}");
}

async fn progress_never_falls(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    for (progress, shown) in [(30, 30), (10, 30), (31, 31)] {
        let point = Point { phase: Some("solve"), progress, ..Point::default() };
        assert!(store.renew(&lease, LEASE, &point).await.unwrap());
        assert_eq!(job(&store, &id).await.progress, shown);
    }
}
