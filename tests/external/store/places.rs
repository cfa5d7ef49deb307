//! The places of jobs in the queue: what a page of a long queue says, and what it costs.

use facies::store::{JobFilter, Store};

use crate::deployments::Deployment;
use crate::processes::until;
use crate::rows::{LEASE, enqueue, job, new_job};
use crate::support::trials::trials;

trials! {
    on_both {
        a_job_that_waits_has_its_place_on_every_page_and_alone
    }
    on_shared {
        a_page_of_a_long_queue_counts_each_job_once
    }
}

async fn places(store: &Store, filter: JobFilter) -> Vec<Option<i64>> {
    let rows = store.jobs(&filter).await.unwrap();
    rows.iter().map(|row| row.queue_position).collect()
}

async fn a_job_that_waits_has_its_place_on_every_page_and_alone(on: Deployment) {
    let store = on.open().await;
    enqueue(&store.of_tenant("other"), "not counted").await;
    enqueue(&store, "runs").await;
    on.execute("UPDATE tenants SET served = 9 WHERE name = 'other'").await;
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().tenant, "default");
    // Studies come last, whenever they were posted.
    let mut ids = Vec::new();
    for (number, priority) in [1, 0, 0, 1, 0].into_iter().enumerate() {
        let mut job = new_job("{}", &number.to_string());
        (job.priority, job.tags) = (priority, vec![format!("p{priority}")]);
        store.enqueue(&job, 99).await.unwrap();
        ids.push(job.id);
    }
    let page = |limit| JobFilter { limit, ..JobFilter::default() };
    let all = [Some(2), Some(4), Some(1), Some(0), Some(3), None];
    assert_eq!(places(&store, page(9)).await, all);
    assert_eq!(places(&store, page(2)).await, all[..2]);
    let rest = JobFilter { cursor: Some(ids[3].clone()), ..page(9) };
    assert_eq!(places(&store, rest).await, all[2..]);
    let studies = JobFilter { tag: "p1".into(), ..page(9) };
    assert_eq!(places(&store, studies).await, [Some(4), Some(3)]);
    for (id, place) in ids.iter().rev().zip(all) {
        assert_eq!(job(&store, id).await.queue_position, place);
    }
}

/// Rows of indexes of `jobs` that were read so far, as the server counts them when a connection ends.
const READ: &str =
    "SELECT SUM(idx_tup_read)::text FROM pg_stat_user_indexes WHERE relname = 'jobs'";

async fn read(on: &Deployment) -> i64 {
    on.texts(READ).await[0].parse().unwrap()
}

async fn a_page_of_a_long_queue_counts_each_job_once(on: Deployment) {
    const WAITING: i64 = 2000;
    const PAGE: i64 = 200;
    on.execute(&format!(
        "INSERT INTO jobs (id, kind, document, spec_hash, engine, status, progress, attempt, losses, \
           claimable_from, created, updated) \
         SELECT 'job-' || n, 'predict', '{{}}', n, 'test', 'accepted', 0, 0, 0, 0, 1, 1 \
         FROM generate_series(1, {WAITING}) AS n; ANALYZE jobs"
    ))
    .await;
    let before = read(&on).await;
    let store = on.open().await;
    let filter = JobFilter { limit: PAGE, ..JobFilter::default() };
    assert_eq!(store.jobs(&filter).await.unwrap().len(), PAGE as usize);
    store.close().await;
    let visited = until("the server has counted", async || {
        Some(read(&on).await - before).filter(|visited| *visited >= PAGE)
    })
    .await;
    assert!(visited < 2 * (WAITING + PAGE), "{visited}");
}
