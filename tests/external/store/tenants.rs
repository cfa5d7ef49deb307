//! Rows of several tenants: each finds its own, and they take turns.

use facies::schema::key::{KeyDocument, Scope};
use facies::store::{AddedCase, ClockDoubt, Dismissal, Enqueued, Store, StoreError};
use serde_json::json;

use crate::deployments::Deployment;
use crate::rows::{LEASE, PAUSE, enqueue, file, mesh, new_case, new_job, result};
use crate::support::trials::trials;

trials! {
    on_both {
        tenants_take_turns_and_studies_come_last
        what_is_older_than_its_tenant_keeps_it_is_erased
        nothing_is_erased_by_a_clock_that_is_suddenly_a_year_ahead
        what_is_stored_or_changed_by_a_clock_far_behind_counts_from_the_newest_time
        what_is_asked_for_again_or_tagged_is_kept_from_then_on
        a_job_that_was_lost_is_accepted_again_when_somebody_says_so
        equal_things_of_two_tenants_are_two_things
        a_key_that_was_ended_is_not_let_in
        a_tenant_has_no_more_keys_in_force_than_it_may
    }
}

async fn claimed(store: &Store) -> String {
    store.claim(LEASE).await.unwrap().unwrap().lease.job
}

async fn tenants_take_turns_and_studies_come_last(on: Deployment) {
    let store = on.open().await;
    let (greedy, modest) = (store.of_tenant("greedy"), store.of_tenant("modest"));
    let mut study = new_job("{}", "study");
    study.priority = 1;
    assert_eq!(greedy.enqueue(&study, 100).await.unwrap(), Enqueued::Accepted);
    let mut many = Vec::new();
    for number in 0..4 {
        many.push(enqueue(&greedy, &format!("job {number}")).await);
    }
    assert_eq!(claimed(&store).await, many[0], "a study waits for what somebody waits for");
    let few = [enqueue(&modest, "job 0").await, enqueue(&modest, "job 1").await];
    for wanted in [&few[0], &many[1], &few[1], &many[2], &many[3], &study.id] {
        assert_eq!(claimed(&store).await, *wanted);
    }
    assert!(store.claim(LEASE).await.unwrap().is_none());
    let full = modest.enqueue(&new_job("{}", "job 3"), 0).await.unwrap();
    assert_eq!(full, Enqueued::QueueFull);
}

async fn what_is_older_than_its_tenant_keeps_it_is_erased(on: Deployment) {
    let store = on.open().await;
    let tenants = ["keeps", "erases"].map(|name| store.of_tenant(name));
    let mut jobs = Vec::new();
    for tenant in &tenants {
        let old = enqueue(tenant, "old").await;
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.publish(&lease, result("{}", &[file("a result")])).await.unwrap());
        let waiting = enqueue(tenant, "waits").await;
        let mesh = mesh("alone", "units=mm");
        assert!(tenant.add_mesh(&mesh).await.unwrap());
        jobs.push([old, waiting, mesh.id]);
    }
    tenants[1].retain(Some(30)).await.unwrap();
    assert_eq!(store.erase_old().await.unwrap(), 0);
    on.execute("UPDATE jobs SET created = 1, updated = 1, finished = 1 WHERE finished IS NOT NULL")
        .await;
    on.execute("UPDATE meshes SET created = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 2);
    let there = async |tenant: &Store, ids: &[String; 3]| {
        [
            tenant.job(&ids[0]).await.unwrap().is_some(),
            tenant.job(&ids[1]).await.unwrap().is_some(),
            tenant.mesh(&ids[2]).await.unwrap().is_some(),
        ]
    };
    assert_eq!(there(&tenants[0], &jobs[0]).await, [true, true, true]);
    assert_eq!(there(&tenants[1], &jobs[1]).await, [false, true, false]);
    assert!(tenants[1].erased(&jobs[1][0]).await.unwrap().is_some());
    assert!(tenants[0].erased(&jobs[1][0]).await.unwrap().is_none());
}

/// The times of rows and of the clock as it was seen go back instead.
async fn nothing_is_erased_by_a_clock_that_is_suddenly_a_year_ahead(on: Deployment) {
    const YEAR: &str = "366 * CAST(86400000 AS BIGINT)";
    let store = on.open().await.of_tenant("a");
    store.retain(Some(365)).await.unwrap();
    let stored = mesh("a year old", "units=mm");
    assert!(store.add_mesh(&stored).await.unwrap());
    assert_eq!((store.erase_old().await.unwrap(), store.clock_doubt().await.unwrap()), (0, None));
    on.execute(&format!("UPDATE meshes SET created = created - {YEAR}")).await;
    on.execute(&format!(
        "UPDATE seen_clock SET trusted = trusted - {YEAR}, latest = latest - {YEAR}"
    ))
    .await;
    for _ in 0..2 {
        assert_eq!(store.erase_old().await.unwrap(), 0);
        let doubt = store.clock_doubt().await.unwrap();
        assert_eq!(doubt, Some(ClockDoubt::Ahead { hours: 366 * 24, trusted_in_h: 7 * 24 }));
    }
    // Without what was seen, as after an import, the rows tell it.
    on.execute("DELETE FROM seen_clock").await;
    assert_eq!(store.erase_old().await.unwrap(), 0);
    assert!(store.mesh(&stored.id).await.unwrap().is_some());
    store.trust_clock().await.unwrap();
    assert_eq!((store.erase_old().await.unwrap(), store.clock_doubt().await.unwrap()), (1, None));
}

/// The time at which the deployment was seen to run goes forward instead.
async fn what_is_stored_or_changed_by_a_clock_far_behind_counts_from_the_newest_time(
    on: Deployment,
) {
    const YEAR: &str = "366 * CAST(86400000 AS BIGINT)";
    let store = on.open().await.of_tenant("a");
    store.retain(Some(30)).await.unwrap();
    let old = new_case();
    assert_eq!(store.add_case(&old, 9).await.unwrap(), AddedCase::Stored);
    assert_eq!(store.erase_old().await.unwrap(), 0);
    on.execute(&format!(
        "UPDATE seen_clock SET trusted = trusted + {YEAR}, latest = latest + {YEAR}"
    ))
    .await;
    assert_eq!(store.erase_old().await.unwrap(), 0);
    let doubt = store.clock_doubt().await.unwrap();
    assert!(matches!(doubt, Some(ClockDoubt::Behind { hours: 8783..=8784 })), "{doubt:?}");

    let case = new_case();
    assert_eq!(store.add_case(&case, 9).await.unwrap(), AddedCase::Stored);
    let lone = mesh("alone", "units=mm");
    assert!(store.add_mesh(&lone).await.unwrap());
    let mut of_old = new_job("{}", "of the old case");
    of_old.case_id = Some(old.id.clone());
    assert_eq!(store.enqueue(&of_old, 9).await.unwrap(), Enqueued::Accepted);
    let ended = enqueue(&store, "ended").await;
    for _ in 0..2 {
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.publish(&lease, result("{}", &[])).await.unwrap());
    }

    // The clock is right again.
    for (table, column) in [("cases", "updated"), ("jobs", "updated"), ("meshes", "created")] {
        on.execute(&format!("UPDATE {table} SET {column} = {column} - {YEAR}")).await;
    }
    on.execute(&format!(
        "UPDATE seen_clock SET trusted = trusted - {YEAR}, latest = latest - {YEAR}"
    ))
    .await;
    assert_eq!((store.erase_old().await.unwrap(), store.clock_doubt().await.unwrap()), (0, None));
    for case in [&old, &case] {
        assert!(store.case(&case.id).await.unwrap().is_some());
    }
    for job in [&of_old.id, &ended] {
        assert!(store.job(job).await.unwrap().is_some(), "{job}");
    }
    assert!(store.mesh(&lone.id).await.unwrap().is_some());
}

async fn what_is_asked_for_again_or_tagged_is_kept_from_then_on(on: Deployment) {
    let store = on.open().await.of_tenant("a");
    let case = new_case();
    assert_eq!(store.add_case(&case, 9).await.unwrap(), AddedCase::Stored);
    let mut of_case = new_job("{}", "of the case");
    of_case.case_id = Some(case.id.clone());
    assert_eq!(store.enqueue(&of_case, 9).await.unwrap(), Enqueued::Accepted);
    let (tagged, left) = (enqueue(&store, "tagged").await, enqueue(&store, "left").await);
    for _ in 0..3 {
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.publish(&lease, result("{}", &[])).await.unwrap());
    }
    let (again, once) = (mesh("again", "units=mm"), mesh("once", "units=mm"));
    assert!(store.add_mesh(&again).await.unwrap() && store.add_mesh(&once).await.unwrap());
    store.retain(Some(30)).await.unwrap();
    on.execute("UPDATE jobs SET created = 1, updated = 1, finished = 1").await;
    on.execute("UPDATE cases SET created = 1, updated = 1").await;
    on.execute("UPDATE meshes SET created = 1").await;
    // The job of the case is posted again without a new tag, as `POST /v1/jobs` does it.
    for (job, add) in [(&of_case.id, vec![]), (&tagged, vec!["main".to_owned()])] {
        assert!(store.change_tags(job, &add, &[], 9).await.unwrap());
    }
    assert!(store.keep_mesh(&again.id).await.unwrap().is_some_and(|kept| kept.created > 1));
    assert_eq!(store.erase_old().await.unwrap(), 2);
    assert!(store.case(&case.id).await.unwrap().is_some());
    for (job, is_there) in [(&of_case.id, true), (&tagged, true), (&left, false)] {
        assert_eq!(store.job(job).await.unwrap().is_some(), is_there, "{job}");
    }
    assert!(store.mesh(&again.id).await.unwrap().is_some());
    assert!(store.mesh(&once.id).await.unwrap().is_none());
    assert!(store.keep_mesh(&once.id).await.unwrap().is_none());
}

async fn a_job_that_was_lost_is_accepted_again_when_somebody_says_so(on: Deployment) {
    let store = on.open().await;
    let own = store.of_tenant("a");
    let (lost, wrong) = (enqueue(&own, "lost").await, enqueue(&own, "wrong").await);
    let error = |class: &str| json!({"type": "worker-lost", "class": class}).to_string();
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 1, PAUSE, &error("infrastructure")).await.unwrap());
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.fail(&lease, &error("numerical")).await.unwrap());
    let listed = store.lost_jobs(None, 9).await.unwrap();
    assert_eq!(listed.iter().map(|row| &row.id).collect::<Vec<_>>(), [&lost]);
    assert_eq!(listed[0].tenant, "a");
    assert!(!store.requeue(&wrong).await.unwrap());
    assert!(store.requeue(&lost).await.unwrap());
    assert!(!store.requeue(&lost).await.unwrap());
    let claim = store.claim(LEASE).await.unwrap().unwrap();
    assert_eq!((claim.lease.job, claim.lease.attempt), (lost, 2));
}

async fn equal_things_of_two_tenants_are_two_things(on: Deployment) {
    let store = on.open().await;
    let (a, b) = (store.of_tenant("a"), store.of_tenant("b"));
    let (first, second) = (mesh("same", "units=mm"), mesh("same", "units=mm"));
    assert!(a.add_mesh(&first).await.unwrap() && b.add_mesh(&second).await.unwrap());
    let again = mesh("same", "units=mm");
    assert!(!a.add_mesh(&again).await.unwrap(), "within a tenant they are one");
    let found = b.mesh_by_content(&second.sha256, &second.options).await.unwrap().unwrap();
    assert_eq!(found.id, second.id);
    let (one, other) = (enqueue(&a, "same").await, enqueue(&b, "same").await);
    assert_eq!(a.enqueue(&new_job("{}", "same"), 9).await.unwrap(), Enqueued::Known(one.clone()));
    assert_eq!(b.job(&other).await.unwrap().unwrap().spec_hash, "same");
    assert_eq!(b.dismiss(&one).await.unwrap(), Dismissal::NotFound);
    assert!(b.job(&one).await.unwrap().is_none());
    // The bytes are stored once, and stay while one of the two is there.
    a.delete_mesh(&first.id).await.unwrap();
    assert!(store.read_blob(&second.blob).await.is_ok());
}

async fn a_key_that_was_ended_is_not_let_in(on: Deployment) {
    let store = on.open().await;
    let (a, b) = (store.of_tenant("a"), store.of_tenant("b"));
    let wanted = KeyDocument { label: "test".into(), scopes: [Scope::Read].into(), days: Some(1) };
    let key = a.make_key(&wanted).await.unwrap();
    let row = store.key_in_force(&key.id).await.unwrap().unwrap();
    assert_eq!((row.tenant.as_str(), row.scopes.as_str()), ("a", "read"));
    // The clock of the database is read twice.
    let in_force_ms = row.expires.unwrap() - row.created;
    assert!((in_force_ms - 24 * 3600 * 1000).abs() < 1000, "{in_force_ms}");
    assert!(!row.hash.contains(&key.text));
    let beside = async |id: &str| store.key_and_responses(id, "no case").await.unwrap();
    assert_eq!(beside(&key.id).await, Some((row, None)));
    assert!(b.rotate_key(&key.id, 0).await.unwrap().is_none(), "it is none of theirs");
    assert!(!b.revoke_key(&key.id).await.unwrap());
    let next = a.rotate_key(&key.id, 0).await.unwrap().unwrap();
    assert!(store.key_in_force(&key.id).await.unwrap().is_none(), "it has given way");
    assert_eq!(beside(&key.id).await, None);
    assert!(a.revoke_key(&next.id).await.unwrap());
    assert!(store.key_in_force(&next.id).await.unwrap().is_none());
    assert_eq!(beside(&next.id).await, None);
    assert!(!a.revoke_key(&next.id).await.unwrap());
}

async fn a_tenant_has_no_more_keys_in_force_than_it_may(on: Deployment) {
    let store = on.open().await.with_key_limit(2);
    let (a, b) = (store.of_tenant("a"), store.of_tenant("b"));
    let wanted = KeyDocument { label: "test".into(), scopes: [Scope::Read].into(), days: Some(1) };
    let (many, last) = (on.again(&store).await.with_key_limit(2).of_tenant("a"), a.clone());
    let made = [&many, &last, &many, &last].map(|store| store.make_key(&wanted));
    let made = futures::future::join_all(made).await;
    assert_eq!(made.iter().filter(|key| key.is_ok()).count(), 2, "of those that came together");
    let refused = made.into_iter().find_map(Result::err).unwrap();
    assert!(matches!(refused, StoreError::TooManyKeys { keys: 2, most: 2 }), "{refused}");
    b.make_key(&wanted).await.unwrap();
    let keys = a.keys(None, 9).await.unwrap();
    assert!(a.rotate_key(&keys[0].id, 1).await.is_err(), "both would be in force");
    let next = a.rotate_key(&keys[0].id, 0).await.unwrap().unwrap();
    assert!(a.revoke_key(&next.id).await.unwrap());
    a.make_key(&wanted).await.unwrap();
    on.execute("UPDATE keys SET expires = 1").await;
    a.make_key(&wanted).await.unwrap();
}
