//! Lists come in pages, and a page costs the same however many rows it has.

use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use facies::config::DatabaseLocation;
use facies::store::{AddedCase, JobFilter, NewCase};
use tracing::field::{Field, Visit};
use tracing::instrument::WithSubscriber;
use tracing::subscriber::NoSubscriber;
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};

use crate::deployments::Deployment;
use crate::rows::{lose_jobs, make_keys, new_case, new_job};
use crate::support::trials::trials;

trials! {
    on_both {
        every_listed_job_has_its_own_tags_in_order
        each_page_begins_behind_the_one_before
        the_command_prints_every_key_of_a_tenant
    }
    on_shared {
        a_page_is_one_statement_however_many_rows_it_has
    }
}

fn ids<T>(rows: Vec<T>, id: impl Fn(T) -> String) -> Vec<String> {
    rows.into_iter().map(id).collect()
}

async fn every_listed_job_has_its_own_tags_in_order(on: Deployment) {
    let store = on.open().await;
    let tags = [vec![], vec!["b, c", "a d", "~", "é"], vec!["'|;\"\\"]];
    for (number, tags) in tags.iter().enumerate() {
        let mut job = new_job("{}", &number.to_string());
        job.tags = tags.iter().map(|tag| (*tag).to_owned()).collect();
        store.enqueue(&job, 9).await.unwrap();
    }
    let filter = JobFilter { limit: 9, ..JobFilter::default() };
    let listed = store.jobs(&filter).await.unwrap();
    let found: Vec<_> = listed.iter().rev().map(|job| job.tags.clone()).collect();
    assert_eq!(found, [vec![], vec!["a d", "b, c", "~", "é"], vec!["'|;\"\\"]]);
    let alone = store.job(&listed[1].id).await.unwrap().unwrap();
    assert_eq!(alone.tags, listed[1].tags);
}

async fn each_page_begins_behind_the_one_before(on: Deployment) {
    let store = on.open().await;
    for tenant in ["c", "a", "b.1"] {
        make_keys(&store.of_tenant(tenant), 3).await;
    }
    // Keys of the same millisecond come in the order of their ids.
    on.execute("UPDATE keys SET created = 1 WHERE tenant = 'a'").await;
    let own = store.of_tenant("a");
    let all = ids(own.keys(None, 9).await.unwrap(), |row| row.id);
    assert_eq!(all.iter().cloned().collect::<BTreeSet<_>>().len(), 3);
    let first = ids(own.keys(None, 2).await.unwrap(), |row| row.id);
    assert_eq!(first, all[..2]);
    let next = ids(own.keys(Some(&all[1]), 2).await.unwrap(), |row| row.id);
    assert_eq!(next, all[2..]);
    let other = store.of_tenant("c");
    assert!(other.keys(Some(&all[0]), 9).await.unwrap().is_empty(), "a cursor of another tenant");

    lose_jobs(&own, 3).await;
    let all = ids(store.lost_jobs(None, 9).await.unwrap(), |row| row.id);
    assert_eq!(ids(store.lost_jobs(None, 2).await.unwrap(), |row| row.id), all[..2]);
    assert_eq!(ids(store.lost_jobs(Some(&all[1]), 2).await.unwrap(), |row| row.id), all[2..]);

    assert_eq!(ids(store.tenants(None, 2).await.unwrap(), |row| row.name), ["a", "b.1"]);
    assert_eq!(ids(store.tenants(Some("b.1"), 2).await.unwrap(), |row| row.name), ["c"]);
}

async fn the_command_prints_every_key_of_a_tenant(on: Deployment) {
    let store = on.open().await;
    make_keys(&store.of_tenant("other"), 1).await;
    make_keys(&store.of_tenant("ward"), 1).await;
    let keys = (0..449).map(|number| format!("('{number:012x}', 'ward', 'many', '', 'read', 1)"));
    let keys = keys.collect::<Vec<_>>().join(", ");
    on.execute(&format!(
        "INSERT INTO keys (id, tenant, label, hash, scopes, created) VALUES {keys}"
    ))
    .await;
    store.close().await;
    drop(store);
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.args(["admin", "key", "list", "--tenant", "ward"]);
    match on.places.database {
        DatabaseLocation::Embedded => drop(command.arg("--data").arg(&on.places.data)),
        DatabaseLocation::Server { .. } => on.bring(&mut command),
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let printed: BTreeSet<&str> = text.lines().map(|line| &line[..12]).collect();
    assert_eq!((text.lines().count(), printed.len()), (450, 450));
}

/// Counts the questions among the statements that the driver tells of: a connection that is made anew sets its limits.
struct Statements(Arc<AtomicUsize>);

/// Whether a field of an event begins a question.
struct Question(bool);

impl Visit for Question {
    fn record_str(&mut self, field: &Field, value: &str) {
        let begins_one = ["SELECT", "WITH"].iter().any(|word| value.starts_with(word));
        self.0 |= field.name() == "summary" && begins_one;
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}

impl<S: tracing::Subscriber> Layer<S> for Statements {
    fn on_event(&self, event: &tracing::Event<'_>, _: Context<'_, S>) {
        let mut found = Question(false);
        event.record(&mut found);
        if found.0 && event.metadata().target() == "sqlx::query" {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// What a future answers, and how many statements it took.
async fn counted<T>(work: impl Future<Output = Vec<T>>) -> (usize, usize) {
    // With one subscriber in the process, the thread of another test that comes by a statement first would decide by itself,
    // for all, that nobody wants to be told of it (`Dispatchers::rebuilder` of tracing-core).
    let _second = tracing::Dispatch::new(NoSubscriber::default());
    let count = Arc::new(AtomicUsize::new(0));
    let subscriber = tracing_subscriber::registry().with(Statements(count.clone()));
    let rows = work.with_subscriber(subscriber).await.len();
    (rows, count.load(Ordering::Relaxed))
}

/// On PostgreSQL only, since statements of SQLite are told by a thread of the driver's own; the code is the same.
async fn a_page_is_one_statement_however_many_rows_it_has(on: Deployment) {
    let store = on.open().await;
    let case =
        |id: &str| NewCase { id: id.into(), tags: vec!["a".into(), "b".into()], ..new_case() };
    let id = || uuid::Uuid::now_v7().to_string();
    let parent = id();
    assert_eq!(store.add_case(&case(&parent), 100).await.unwrap(), AddedCase::Stored);
    for number in 0..4 {
        assert_eq!(store.add_case(&case(&id()), 100).await.unwrap(), AddedCase::Stored);
        assert!(store.add_plan(&parent, &id(), "{}").await.unwrap());
        make_keys(&store.of_tenant(&format!("tenant-{number}")), 1).await;
    }
    make_keys(&store, 4).await;
    lose_jobs(&store, 4).await;
    for rows in [1, 4] {
        let limit = i64::try_from(rows).unwrap();
        let filter = JobFilter { limit, ..JobFilter::default() };
        let pages = [
            counted(async { store.jobs(&filter).await.unwrap() }).await,
            counted(async { store.cases("a", None, limit).await.unwrap() }).await,
            counted(async { store.plans(&parent, None, limit).await.unwrap() }).await,
            counted(async { store.keys(None, limit).await.unwrap() }).await,
            counted(async { store.tenants(None, limit).await.unwrap() }).await,
            counted(async { store.lost_jobs(None, limit).await.unwrap() }).await,
        ];
        assert_eq!(pages, [(rows, 1); 6]);
    }
}
