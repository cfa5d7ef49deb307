//! Several processes at the same rows and the same bytes at the same time.

use std::collections::BTreeSet;

use facies::schema::job::JobStatus;
use facies::store::{AddedCase, Dismissal, Enqueued, MeshDeletion, Point, Store, StoreError};
use tokio::task::JoinSet;

use crate::deployments::Deployment;
use crate::rows::mesh;
use crate::rows::{LEASE, blob_count, enqueue, file, new_case, new_job, result};
use crate::support::trials::trials;

trials! {
    on_both {
        no_job_is_claimed_twice
        fifty_requests_with_the_same_inputs_are_one_job
        a_dismissal_and_a_publication_have_one_winner
        bytes_that_are_stored_and_removed_at_the_same_time_are_never_missed
        a_case_is_erased_while_jobs_come
        events_of_a_job_are_numbered_without_gaps_and_go_with_it
    }
    on_shared {
        a_process_that_waits_is_woken_by_the_change_of_another
    }
}

/// A process is a store with connections of its own.
async fn processes(on: &Deployment, count: usize) -> Vec<Store> {
    let first = on.open().await;
    let mut stores = vec![first];
    while stores.len() < count {
        stores.push(on.again(&stores[0]).await);
    }
    stores
}

async fn no_job_is_claimed_twice(on: Deployment) {
    let stores = processes(&on, 4).await;
    let mut jobs = BTreeSet::new();
    for number in 0..40 {
        jobs.insert(enqueue(&stores[0], &number.to_string()).await);
    }
    let mut workers = JoinSet::new();
    for store in stores.iter().cycle().take(8) {
        let store = store.clone();
        workers.spawn(async move {
            let mut claimed = Vec::new();
            while let Some(claim) = store.claim(LEASE).await.unwrap() {
                claimed.push(claim.lease.job);
            }
            claimed
        });
    }
    let claimed: Vec<String> = workers.join_all().await.into_iter().flatten().collect();
    assert_eq!(claimed.len(), 40);
    assert_eq!(claimed.into_iter().collect::<BTreeSet<_>>(), jobs);
}

async fn fifty_requests_with_the_same_inputs_are_one_job(on: Deployment) {
    let stores = processes(&on, 4).await;
    let mut requests = JoinSet::new();
    for store in stores.iter().cycle().take(50) {
        let store = store.clone();
        let job = new_job("{}", "the same");
        requests.spawn(async move { (job.id.clone(), store.enqueue(&job, 100).await.unwrap()) });
    }
    let answers = requests.join_all().await;
    let mut accepted = answers.iter().filter(|(_, answer)| *answer == Enqueued::Accepted);
    let (winner, _) = accepted.next().expect("one is accepted");
    assert!(accepted.next().is_none(), "and no other");
    let known = answers.iter().filter(|(_, answer)| *answer == Enqueued::Known(winner.clone()));
    assert_eq!(known.count(), 49);
}

async fn a_dismissal_and_a_publication_have_one_winner(on: Deployment) {
    let stores = processes(&on, 2).await;
    for round in 0..20 {
        let id = enqueue(&stores[0], &round.to_string()).await;
        let lease = stores[0].claim(LEASE).await.unwrap().unwrap().lease;
        let files = [file("result")];
        let (published, dismissal) =
            tokio::join!(stores[0].publish(&lease, result("{}", &files)), stores[1].dismiss(&id));
        let left = stores[0].job(&id).await.unwrap();
        match (published.unwrap(), dismissal.unwrap()) {
            (false, Dismissal::Dismissed) => {
                assert_eq!(left.unwrap().status, JobStatus::Dismissed);
            }
            // The publication came first, and what has ended is removed.
            (true, Dismissal::Removed) => assert!(left.is_none()),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(blob_count(&stores[0]).await, 0);
}

async fn bytes_that_are_stored_and_removed_at_the_same_time_are_never_missed(on: Deployment) {
    let stores = processes(&on, 4).await;
    let mut clients = JoinSet::new();
    for (client, store) in stores.iter().cycle().take(6).cloned().enumerate() {
        clients.spawn(async move {
            for round in 0..15 {
                // All store the same bytes, as meshes of their own.
                let mesh = mesh("the same", &format!("{client} {round}"));
                let added = loop {
                    match store.add_mesh(&mesh).await {
                        // Told to come back, a client does.
                        Err(StoreError::Contended) => {}
                        added => break added.unwrap(),
                    }
                };
                assert!(added);
                assert_eq!(store.read_blob(&mesh.blob).await.unwrap(), "the same");
                let deleted = store.delete_mesh(&mesh.id).await.unwrap();
                assert_eq!(deleted, MeshDeletion::Deleted);
            }
        });
    }
    clients.join_all().await;
    assert_eq!(blob_count(&stores[0]).await, 0);
    assert_eq!(on.objects().len(), 0);
}

async fn a_case_is_erased_while_jobs_come(on: Deployment) {
    let stores = processes(&on, 2).await;
    for round in 0..10 {
        let mesh = mesh("of the case", &round.to_string());
        let case = facies::store::NewCase {
            mesh_ids: vec![mesh.id.clone()],
            meshes: vec![facies::store::NewMesh { standalone: false, ..mesh.clone() }],
            ..new_case()
        };
        assert_eq!(stores[0].add_case(&case, 100).await.unwrap(), AddedCase::Stored);
        let mut job = new_job("{}", &format!("job {round}"));
        job.case_id = Some(case.id.clone());
        job.mesh_ids = vec![mesh.id.clone()];
        let (enqueued, erased) =
            tokio::join!(stores[0].enqueue(&job, 100), stores[1].delete_case(&case.id, None));
        assert_eq!(erased.unwrap(), facies::store::Change::Done);
        let enqueued = enqueued.unwrap();
        assert!(matches!(enqueued, Enqueued::Accepted | Enqueued::InputGone), "{enqueued:?}");
        assert!(stores[0].job(&job.id).await.unwrap().is_none(), "it goes with its case");
        assert!(stores[0].mesh(&mesh.id).await.unwrap().is_none());
    }
    assert_eq!(blob_count(&stores[0]).await, 0);
}

async fn a_process_that_waits_is_woken_by_the_change_of_another(on: Deployment) {
    let stores = processes(&on, 2).await;
    let mut changes = stores[1].job_changes();
    let woken = async {
        // It may not listen yet when the first change comes.
        for number in 0.. {
            enqueue(&stores[0], &number.to_string()).await;
            let patience = std::time::Duration::from_secs(1);
            if tokio::time::timeout(patience, changes.of_any()).await.is_ok() {
                return;
            }
        }
    };
    tokio::time::timeout(std::time::Duration::from_secs(60), woken).await.expect("it is woken");
}

async fn events_of_a_job_are_numbered_without_gaps_and_go_with_it(on: Deployment) {
    let stores = processes(&on, 4).await;
    let id = enqueue(&stores[0], "a").await;
    let lease = stores[0].claim(LEASE).await.unwrap().unwrap().lease;
    let mut writers = JoinSet::new();
    for (progress, store) in (1..=20).zip(stores.iter().cycle()) {
        let (store, lease) = (store.clone(), lease.clone());
        writers.spawn(async move {
            let point = Point { progress, ..Point::default() };
            assert!(store.renew(&lease, LEASE, &point).await.unwrap());
            store.record_job(&lease.job).await.unwrap();
        });
    }
    writers.join_all().await;
    assert_eq!(stores[1].dismiss(&id).await.unwrap(), Dismissal::Dismissed);
    let events = stores[2].job_events(&id, 0).await.unwrap().unwrap();
    let numbers: Vec<i64> = events.iter().map(|event| event.number).collect();
    assert_eq!(numbers, (1..=events.len() as i64).collect::<Vec<_>>());
    assert!(events.is_sorted_by_key(|event| event.progress), "{events:?}");
    assert_eq!(events.last().unwrap().status, JobStatus::Dismissed);
    assert_eq!(stores[3].erased(&id).await.unwrap(), None);
    assert_eq!(stores[3].dismiss(&id).await.unwrap(), Dismissal::Removed);
    assert!(stores[0].erased(&id).await.unwrap().is_some());
    assert_eq!(stores[0].job_events(&id, 0).await.unwrap(), None);
}
