//! Who is served next, and by which program.

use facies::config::DatabaseLocation;
use facies::schema::engine::EngineDocument;
use facies::store::Enqueued;
use serde_json::json;
use sqlx::{Connection, PgConnection};

use crate::deployments::Deployment;
use crate::rows::{LEASE, enqueue, job, new_job, result};
use crate::support::trials::trials;

trials! {
    on_both {
        a_tenant_with_long_jobs_does_not_take_every_slot_that_another_gives_back
        a_job_of_a_later_program_is_left_to_it
        a_job_that_another_version_ran_says_which
        a_hash_that_another_job_has_is_left_to_it
    }
    on_shared {
        rows_of_one_tenant_that_somebody_holds_keep_no_other_waiting
    }
}

async fn a_tenant_with_long_jobs_does_not_take_every_slot_that_another_gives_back(on: Deployment) {
    let store = on.open().await;
    let (long, short) = (store.of_tenant("long"), store.of_tenant("short"));
    let claimed = async || store.claim(LEASE).await.unwrap().unwrap();
    // Two slots. One tenant alone has both: no slot is idle while a job waits.
    for number in 0..4 {
        enqueue(&long, &format!("an hour {number}")).await;
    }
    let (first, second) = (claimed().await, claimed().await);
    assert_eq!((first.tenant.as_str(), second.tenant.as_str()), ("long", "long"));
    for number in 0..3 {
        enqueue(&short, &format!("a second {number}")).await;
    }
    assert!(store.publish(&first.lease, result("{}", &[])).await.unwrap());
    // The other tenant has the first slot that is free, and each time again: `long` holds one.
    for _ in 0..3 {
        let next = claimed().await;
        assert_eq!(next.tenant, "short");
        assert!(store.publish(&next.lease, result("{}", &[])).await.unwrap());
    }
    assert_eq!(claimed().await.tenant, "long", "nobody else waits");
}

async fn rows_of_one_tenant_that_somebody_holds_keep_no_other_waiting(on: Deployment) {
    let store = on.open().await;
    let (alpha, beta) = (store.of_tenant("alpha"), store.of_tenant("beta"));
    enqueue(&alpha, "held").await;
    let other = enqueue(&beta, "free").await;
    let DatabaseLocation::Server { address, .. } = &on.places.database else {
        panic!("it is shared")
    };
    let mut holder = PgConnection::connect(address.reveal()).await.unwrap();
    let mut held = holder.begin().await.unwrap();
    let lock = "SELECT 1 FROM jobs, tenants WHERE tenants.name = jobs.tenant AND tenant = 'alpha' FOR UPDATE";
    sqlx::raw_sql(lock).execute(&mut *held).await.unwrap();
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().lease.job, other);
    // Another job of the same tenant is free; its turn is somebody else's to count.
    let next = enqueue(&alpha, "free too").await;
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().lease.job, next);
    assert!(store.claim(LEASE).await.unwrap().is_none());
    held.rollback().await.unwrap();
    assert!(store.claim(LEASE).await.unwrap().is_some());
}

async fn a_job_of_a_later_program_is_left_to_it(on: Deployment) {
    let store = on.open().await;
    let later = enqueue(&store, "later").await;
    on.execute("UPDATE jobs SET numerics = numerics + 1").await;
    assert!(store.claim(LEASE).await.unwrap().is_none());
    let own = enqueue(&store, "own").await;
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().lease.job, own);
    assert!(store.claim(LEASE).await.unwrap().is_none());
    on.execute("UPDATE jobs SET numerics = 0").await;
    assert_eq!(store.claim(LEASE).await.unwrap().unwrap().lease.job, later, "an earlier one");
}

/// The manifest of a result of this program.
fn manifest(spec_hash: &str) -> String {
    json!({"provenance": {"engine": EngineDocument::this(), "spec_hash": spec_hash}}).to_string()
}

async fn a_job_that_another_version_ran_says_which(on: Deployment) {
    let store = on.open().await.of_tenant("ward");
    let earlier = EngineDocument { version: "0.0.9".into(), ..EngineDocument::this() };
    for (accepted_by, hash) in [(earlier, "now"), (EngineDocument::this(), "then")] {
        let mut new = new_job("{}", "then");
        new.engine = serde_json::to_string(&accepted_by).unwrap();
        assert_eq!(store.enqueue(&new, 9).await.unwrap(), Enqueued::Accepted);
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.publish(&lease, result(&manifest("now"), &[])).await.unwrap());
        let row = job(&store, &new.id).await;
        let engine: EngineDocument = serde_json::from_str(&row.engine).unwrap();
        assert_eq!((engine, row.spec_hash.as_str()), (EngineDocument::this(), hash));
    }
    let again = store.enqueue(&new_job("{}", "now"), 9).await.unwrap();
    assert!(matches!(again, Enqueued::Known(_)), "what was found is known by its hash");
}

async fn a_hash_that_another_job_has_is_left_to_it(on: Deployment) {
    let store = on.open().await;
    let earlier = EngineDocument { numerics: 0, ..EngineDocument::this() };
    let mut new = new_job("{}", "then");
    new.engine = serde_json::to_string(&earlier).unwrap();
    store.enqueue(&new, 9).await.unwrap();
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    enqueue(&store, "now").await;
    assert!(store.publish(&lease, result(&manifest("now"), &[])).await.unwrap());
    let row = job(&store, &new.id).await;
    assert_eq!(row.spec_hash, "then");
    assert_eq!(row.engine, serde_json::to_string(&EngineDocument::this()).unwrap());
}
