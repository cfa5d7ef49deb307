//! What the store remembers for clients, on both engines: events of jobs, keys of requests, what was erased.

use facies::schema::job::JobStatus;
use facies::store::{AddedCase, Change, Dismissal, NewCase, Point, Reserved};

use crate::deployments::Deployment;
use crate::rows::{LEASE, PAUSE, enqueue, new_case, new_job, result};
use crate::support::trials::trials;

trials! {
    on_both {
        every_change_of_a_job_that_can_be_seen_is_one_event
        events_of_many_writers_have_numbers_without_gaps
        only_the_last_thousand_events_are_kept
        a_key_belongs_to_the_request_that_used_it_first
        what_was_erased_is_remembered_with_all_that_went_with_it
    }
}

async fn every_change_of_a_job_that_can_be_seen_is_one_event(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let solving = Point { phase: Some("solve"), progress: 30, ..Point::default() };
    for _ in 0..3 {
        // A sign of life that tells nothing else is none.
        assert!(store.renew(&lease, LEASE, &solving).await.unwrap());
    }
    // A solver that goes on is heard, however little its residual falls.
    let going_on = Point { iteration: Some(7), ..solving };
    assert!(store.renew(&lease, LEASE, &going_on).await.unwrap());
    assert!(store.release(&lease).await.unwrap());
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 3, PAUSE, "{}").await.unwrap());
    on.execute("UPDATE jobs SET claimable_from = 0").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    on.execute("UPDATE jobs SET lease_expires = 1").await;
    assert_eq!(store.reap(3, "{}").await.unwrap().len(), 1);
    let late = store.claim(LEASE).await.unwrap().unwrap().lease;
    // Of a lease that is not the job's any more nothing is told.
    assert!(!store.fail(&lease, "{}").await.unwrap());
    assert!(store.publish(&late, result("{}", &[])).await.unwrap());

    use JobStatus::{Accepted, Running, Successful};
    let events = store.job_events(&id, 0).await.unwrap().unwrap();
    let told: Vec<_> = events.iter().map(|event| (event.status, event.attempt)).collect();
    assert_eq!(
        told,
        [
            (Accepted, 0),
            (Running, 1),
            (Running, 1),
            (Running, 1),
            (Accepted, 1),
            (Running, 2),
            (Accepted, 2),
            (Running, 3),
            (Accepted, 3),
            (Running, 4),
            (Successful, 4),
        ]
    );
    assert_eq!((events[2].phase.as_deref(), events[2].progress), (Some("solve"), 30));
    assert_eq!((events[3].progress, events[3].iteration), (30, Some(7)));
    assert!(events.iter().zip(1..).all(|(event, number)| event.number == number));
    assert_eq!(store.job_events(&id, 7).await.unwrap().unwrap(), events[7..]);
    assert_eq!(store.job_events(&id, 11).await.unwrap().unwrap(), []);
    // Written down once more, the same state is no event.
    store.record_job(&id).await.unwrap();
    assert_eq!(store.job_events(&id, 11).await.unwrap().unwrap(), []);
    let nobody = uuid::Uuid::now_v7().to_string();
    assert!(store.job_events(&nobody, 0).await.unwrap().is_none());
}

async fn events_of_many_writers_have_numbers_without_gaps(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let other = on.again(&store).await;
    let renew = |progress: i64| {
        let (store, lease) = if progress % 2 == 0 { (&store, &lease) } else { (&other, &lease) };
        async move {
            let point = Point { phase: Some("solve"), progress, ..Point::default() };
            assert!(store.renew(lease, LEASE, &point).await.unwrap());
        }
    };
    futures::future::join_all((1..=40).map(renew)).await;
    let events = store.job_events(&id, 0).await.unwrap().unwrap();
    assert!(events.iter().zip(1..).all(|(event, number)| event.number == number), "{events:?}");
    assert!(events.is_sorted_by_key(|event| event.progress), "{events:?}");
    assert_eq!(events.last().unwrap().progress, 40);
}

async fn only_the_last_thousand_events_are_kept(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    on.execute("UPDATE job_events SET number = number + 1500").await;
    let point = Point { phase: Some("solve"), progress: 1, ..Point::default() };
    assert!(store.renew(&lease, LEASE, &point).await.unwrap());
    on.execute("UPDATE job_events SET number = number - 1400 WHERE number < 1503").await;
    let point = Point { phase: Some("write"), progress: 1, ..Point::default() };
    assert!(store.renew(&lease, LEASE, &point).await.unwrap());
    let events = store.job_events(&id, 0).await.unwrap().unwrap();
    assert_eq!(events.iter().map(|event| event.number).collect::<Vec<_>>(), [1503, 1504]);
}

async fn a_key_belongs_to_the_request_that_used_it_first(on: Deployment) {
    let store = on.open().await;
    let other = on.again(&store).await;
    let reserve = |store, id: &'static str| {
        let store: &facies::store::Store = store;
        async move { store.reserve("key", "request", id).await.unwrap() }
    };
    let together =
        [reserve(&store, "a"), reserve(&other, "b"), reserve(&store, "c"), reserve(&other, "d")];
    let found = futures::future::join_all(together).await;
    let first = found.iter().zip(["a", "b", "c", "d"]).filter(|(it, _)| **it == Reserved::Fresh);
    let [id] = first.map(|(_, id)| id).collect::<Vec<_>>()[..] else { panic!("{found:?}") };
    let again = Reserved::Again { id: id.to_owned(), found: false };
    assert_eq!(found.iter().filter(|it| **it == again).count(), 3);
    assert_eq!(store.reserve("key", "another", "e").await.unwrap(), Reserved::Other);
    store.remember_found("key", "earlier").await.unwrap();
    let found = Reserved::Again { id: "earlier".into(), found: true };
    assert_eq!(store.reserve("key", "request", "f").await.unwrap(), found);
    // After a day it is anybody's.
    on.execute("UPDATE idempotency_keys SET created = created - 86400001").await;
    assert_eq!(store.reserve("key", "another", "e").await.unwrap(), Reserved::Fresh);
}

async fn what_was_erased_is_remembered_with_all_that_went_with_it(on: Deployment) {
    let store = on.open().await;
    let case = NewCase { report: "null".into(), ..new_case() };
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    let plan = uuid::Uuid::now_v7().to_string();
    for _ in 0..2 {
        // Sent twice at the same time, it is there.
        assert!(store.add_plan(&case.id, &plan, "{}").await.unwrap());
    }
    let mut own = new_job("{}", "own");
    own.case_id = Some(case.id.clone());
    let mut shared = new_job("{}", "shared");
    shared.shared_cases = vec![case.id.clone()];
    for job in [&own, &shared] {
        store.enqueue(job, 100).await.unwrap();
    }
    let other = enqueue(&store, "other").await;
    let ids = [&case.id, &plan, &own.id, &shared.id];
    for id in ids {
        assert_eq!(store.erased(id).await.unwrap(), None);
    }
    assert_eq!(store.delete_case(&case.id, Some(1)).await.unwrap(), Change::Done);
    for id in ids {
        assert!(store.erased(id).await.unwrap().is_some_and(|when| when > 0), "{id}");
    }
    assert_eq!(store.dismiss(&other).await.unwrap(), Dismissal::Dismissed);
    assert_eq!(store.erased(&other).await.unwrap(), None);
    assert_eq!(store.dismiss(&other).await.unwrap(), Dismissal::Removed);
    assert!(store.erased(&other).await.unwrap().is_some());
}
