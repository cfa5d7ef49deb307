//! The audit log: what was done is in it, and what cannot be noted is not done.

use std::collections::BTreeSet;
use std::sync::Arc;

use facies::store::{AuditedAction, Chain, Store};
use reqwest::StatusCode;
use serde_json::json;
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};

use crate::deployments::{Cluster, Deployment};
use crate::helpers::{SMALL, Server, ask};
use crate::processes::until;
use crate::support::external::Missing;
use crate::support::trials::trials;

trials! {
    on_both {
        the_audit_log_shows_what_was_changed
        a_row_of_the_audit_log_outside_its_chain_shows
        an_audited_action_whose_end_nobody_told_is_in_the_audit_log_as_unknown
        an_audited_action_of_a_process_that_lives_is_never_unknown
        an_end_that_the_database_did_not_take_is_reported_later
    }
    alone {
        what_cannot_be_noted_is_not_done
        no_end_is_lost_and_none_told_twice_where_the_database_crashes
    }
    on_shared {
        audited_actions_at_the_same_time_are_noted_together
    }
}

async fn what_cannot_be_noted_is_not_done() {
    let server = Server::start();
    let database = |change: &'static str| {
        let path = server.path().join("facies.db");
        async move {
            let options = SqliteConnectOptions::new().filename(path);
            let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
            sqlx::raw_sql(change).execute(&mut connection).await.unwrap();
        }
    };
    database("ALTER TABLE deeds RENAME TO lost").await;
    let made = ask(server.post("/v1/cases").multipart(SMALL.form(&SMALL.case()))).await;
    made.problem(500, "internal");
    let cases = ask(server.get("/v1/cases")).await.expect(StatusCode::OK);
    assert_eq!(cases["items"], json!([]));
    database("ALTER TABLE lost RENAME TO deeds").await;
    server.case(&SMALL).await;
}

async fn the_audit_log_shows_what_was_changed(on: Deployment) {
    let store = on.open().await;
    assert!(matches!(store.check_audit().await.unwrap(), Chain::Whole { rows: 0, .. }));
    let audited = |action: &str, tenant: &str| AuditedAction {
        action: action.into(),
        tenant: tenant.into(),
        ..AuditedAction::default()
    };
    let ten = |store: Store, action: &'static str| async move {
        for _ in 0..5 {
            let begun = store.begin_action(&audited(action, "")).await.unwrap();
            store.end_action(begun, "", "done").await.unwrap();
            store.chain_actions().await.unwrap();
        }
    };
    let both = [tokio::spawn(ten(store.clone(), "one")), tokio::spawn(ten(store.clone(), "other"))];
    for task in both {
        task.await.unwrap();
    }
    let last = store.begin_action(&audited("last", "a")).await.unwrap();
    let Chain::Whole { rows: 10, .. } = store.check_audit().await.unwrap() else {
        panic!("what goes on is not in the chain yet")
    };
    store.end_action(last, "made", "201").await.unwrap();
    let Chain::Whole { rows: 11, hash } = store.check_audit().await.unwrap() else {
        panic!("it is whole")
    };
    let own = store.audit(0, "a", 100).await.unwrap();
    assert_eq!((own.len(), own[0].number, &own[0].hash), (1, 11, &hash));
    assert_eq!((own[0].audited.object.as_str(), own[0].outcome.as_str()), ("made", "201"));
    let broken = async || match store.check_audit().await.unwrap() {
        Chain::Whole { .. } => None,
        Chain::Broken { at } => Some(at),
    };
    on.execute("UPDATE audit SET actor = 'nobody' WHERE number = 4").await;
    assert_eq!(broken().await, Some(4));
    on.execute("UPDATE audit SET actor = '' WHERE number = 4").await;
    assert_eq!(broken().await, None);
    on.execute("DELETE FROM audit WHERE number = 11").await;
    assert_eq!(broken().await, Some(11));
    on.execute("DELETE FROM audit WHERE number = 7").await;
    assert_eq!(broken().await, Some(7));
}

async fn a_row_of_the_audit_log_outside_its_chain_shows(on: Deployment) {
    let store = on.open().await;
    let act = async || {
        let audited = AuditedAction { action: "act".into(), ..AuditedAction::default() };
        let begun = store.begin_action(&audited).await.unwrap();
        store.end_action(begun, "", "done").await.unwrap();
        store.check_audit().await.unwrap()
    };
    let Chain::Whole { rows: 1, hash } = act().await else { panic!("it is whole") };
    for outside in [-3, 0, 2] {
        let columns = "at, tenant, actor, action, object, outcome, request, hash";
        let insert = format!(
            "INSERT INTO audit (number, {columns}) SELECT {outside}, {columns} FROM audit WHERE number = 1"
        );
        on.execute(&insert).await;
        assert_eq!(store.check_audit().await.unwrap(), Chain::Broken { at: outside });
        // Behind the end it stands in the way of the next one.
        assert_eq!(act().await, Chain::Broken { at: outside });
        on.execute("DELETE FROM audit WHERE number <> 1").await;
        on.execute("DELETE FROM deeds").await;
        on.execute(&format!("UPDATE audit_end SET number = 1, hash = '{hash}'")).await;
        let whole = Chain::Whole { rows: 1, hash: hash.clone() };
        assert_eq!(store.check_audit().await.unwrap(), whole);
    }
}

async fn an_audited_action_whose_end_nobody_told_is_in_the_audit_log_as_unknown(on: Deployment) {
    let store = on.open().await;
    let audited = AuditedAction { action: "begun".into(), ..AuditedAction::default() };
    let begun = store.begin_action(&audited).await.unwrap();
    assert_eq!(store.audit(0, "", 10).await.unwrap(), []);
    on.execute(AN_HOUR_LATER).await;
    // As another process does it: the one that began an audited action says first that it goes on.
    store.chain_actions().await.unwrap();
    let rows = store.audit(0, "", 10).await.unwrap();
    assert_eq!((rows.len(), &rows[0].audited, rows[0].outcome.as_str()), (1, &audited, "unknown"));
    store.end_action(begun, "made", "201").await.unwrap();
    let told = store.audit(0, "", 10).await.unwrap();
    assert_eq!((told.len(), &told[0]), (2, &rows[0]), "what is in the chain stays as it is");
    let row = &told[1];
    assert_eq!((row.outcome.as_str(), row.audited.object.as_str()), ("201", "made"));
    assert_eq!((&row.audited.action, &row.audited.request), (&audited.action, &audited.request));
    assert!(matches!(store.check_audit().await.unwrap(), Chain::Whole { rows: 2, .. }));
}

const AN_HOUR_LATER: &str = "UPDATE deeds SET at = at - 3600001, alive = alive - 3600001";

async fn an_audited_action_of_a_process_that_lives_is_never_unknown(on: Deployment) {
    let store = on.open().await;
    let audited = AuditedAction { action: "upload".into(), ..AuditedAction::default() };
    let begun = store.begin_action(&audited).await.unwrap();
    on.execute(AN_HOUR_LATER).await;
    store.write_outcomes().await.unwrap();
    assert_eq!(store.audit(0, "", 10).await.unwrap(), [], "it goes on");
    store.end_action(begun, "mesh", "201").await.unwrap();
    let rows = store.audit(0, "", 10).await.unwrap();
    assert_eq!(rows.len(), 1);
    assert_eq!((rows[0].outcome.as_str(), rows[0].audited.object.as_str()), ("201", "mesh"));
    let forgotten = store.begin_action(&audited).await.unwrap();
    drop(forgotten);
    on.execute(AN_HOUR_LATER).await;
    store.write_outcomes().await.unwrap();
    assert_eq!(store.audit(1, "", 10).await.unwrap()[0].outcome, "unknown", "nobody does it");
}

async fn an_end_that_the_database_did_not_take_is_reported_later(on: Deployment) {
    let store = on.open().await;
    let audited = AuditedAction { action: "crashed".into(), ..AuditedAction::default() };
    let begun = store.begin_action(&audited).await.unwrap();
    on.execute("ALTER TABLE deeds RENAME TO lost").await;
    store.end_action(begun, "job", "201").await.unwrap_err();
    store.write_outcomes().await.unwrap_err();
    on.execute("ALTER TABLE lost RENAME TO deeds").await;
    store.write_outcomes().await.unwrap();
    let rows = store.audit(0, "", 10).await.unwrap();
    assert_eq!((rows.len(), rows[0].outcome.as_str()), (1, "201"));
    store.write_outcomes().await.unwrap();
    assert_eq!(store.audit(0, "", 10).await.unwrap(), rows, "it is told once");
}

async fn audited_actions_at_the_same_time_are_noted_together(on: Deployment) {
    let store = on.open().await;
    let one = |number: usize| {
        let audited =
            AuditedAction { action: format!("number {number}"), ..AuditedAction::default() };
        let store = store.clone();
        async move {
            let begun = store.begin_action(&audited).await.unwrap();
            store.end_action(begun, "", "done").await.unwrap();
        }
    };
    futures::future::join_all((0..300).map(one)).await;
    // What wrote a row last.
    let commits = on.texts("SELECT DISTINCT xmin::text FROM deeds").await.len();
    assert!(commits < 30, "300 ends in {commits} transactions");
    let rows = store.audit(0, "", 1000).await.unwrap();
    assert_eq!(rows.len(), 300);
    assert!(rows.iter().all(|row| row.outcome == "done"));
}

/// What PostgreSQL does not flush by itself for some hundred milliseconds is gone after a crash.
async fn no_end_is_lost_and_none_told_twice_where_the_database_crashes() -> Result<(), Missing> {
    const ACTIONS: usize = 40;
    let cluster = Arc::new(Cluster::start()?);
    let on = Deployment::on(&cluster.database().await);
    Store::migrate(&on.places).await.unwrap();
    let store = on.open().await;
    for round in 0..3 {
        let action = format!("round {round}");
        let begin = |number: usize| {
            let request = number.to_string();
            let audited =
                AuditedAction { action: action.clone(), request, ..AuditedAction::default() };
            let store = &store;
            async move { store.begin_action(&audited).await.unwrap() }
        };
        let begun = futures::future::join_all((0..ACTIONS).map(begin)).await;
        // Some ends are taken and some are not, and of some nobody hears whether they were.
        let ends = begun.into_iter().map(|begun| store.end_action(begun, "", "201"));
        let ends = futures::future::join_all(ends);
        let crashes = cluster.clone();
        let crash = move || crashes.control(&["-m", "immediate", "stop"]);
        if round == 0 {
            ends.await;
            crash();
        } else {
            let (_, crashed) = tokio::join!(ends, tokio::task::spawn_blocking(crash));
            crashed.unwrap();
        }
        cluster.control(&["start"]);
        until("the ends are told", async || store.write_outcomes().await.ok()).await;
        let rows = store.audit(0, "", 1000).await.unwrap();
        let own = rows.iter().filter(|row| row.audited.action == action && row.outcome == "201");
        let requests: BTreeSet<&str> =
            own.clone().map(|row| row.audited.request.as_str()).collect();
        assert_eq!((own.count(), requests.len()), (ACTIONS, ACTIONS), "round {round}");
    }
    assert!(matches!(store.check_audit().await.unwrap(), Chain::Whole { .. }));
    Ok(())
}
