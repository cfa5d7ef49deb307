//! A page of a list costs the same however many rows it has.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use facies::store::{JobFilter, NewCase};
use tracing::field::{Field, Visit};
use tracing::instrument::WithSubscriber;
use tracing::subscriber::NoSubscriber;
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};

use crate::deployments::{Deployment, on_both};
use crate::queue::{enqueue, new_job};

on_both! {
    every_listed_job_has_its_own_tags_in_order
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

/// Counts the questions among the statements that the driver tells of: a connection that is made anew sets its limits.
struct Statements(Arc<AtomicUsize>);

/// Whether a field of an event begins a question.
struct Question(bool);

impl Visit for Question {
    fn record_str(&mut self, field: &Field, value: &str) {
        self.0 |= field.name() == "summary" && value.starts_with("SELECT");
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
#[tokio::test]
async fn a_page_is_one_statement_however_many_rows_it_has() {
    let Some(on) = Deployment::shared().await else { return };
    let store = on.open().await;
    let case = |id: &str| NewCase {
        id: id.into(),
        document: "{}".into(),
        report: "{}".into(),
        tags: vec!["a".into(), "b".into()],
        mesh_ids: Vec::new(),
        meshes: Vec::new(),
    };
    let id = || uuid::Uuid::now_v7().to_string();
    let parent = id();
    assert!(store.add_case(&case(&parent)).await.unwrap());
    for number in 0..4 {
        assert!(store.add_case(&case(&id())).await.unwrap());
        assert!(store.add_plan(&parent, &id(), "{}").await.unwrap());
        enqueue(&store, &number.to_string()).await;
    }
    for rows in [1, 4] {
        let limit = i64::try_from(rows).unwrap();
        let filter = JobFilter { limit, ..JobFilter::default() };
        let pages = [
            counted(async { store.jobs(&filter).await.unwrap() }).await,
            counted(async { store.cases("a", None, limit).await.unwrap() }).await,
            counted(async { store.plans(&parent, None, limit).await.unwrap() }).await,
        ];
        assert_eq!(pages, [(rows, 1); 3]);
    }
}
