//! Requests whose clients leave: what has changed nothing ends with its client, and nobody waits for it.

use std::time::{Duration, Instant};

use reqwest::StatusCode;
use serde_json::{Value, json};
use sqlx::{Connection as _, SqliteConnection};
use tempfile::TempDir;

use super::tenants::Hospital;
use crate::connections::send;
use crate::helpers::{Block, SMALL, Server, ask, spec};
use crate::processes::{is_quick, until};

/// One who waits to write to a locked database is told so after five seconds.
const LESS_THAN_A_WRITER_WAITS: Duration = Duration::from_secs(4);
const UNDER_WAY: &str = "facies_http_requests_in_flight";
const BODIES: &str = "facies_http_body_bytes_in_flight";
const PARSE: &str = "facies_http_requests_waiting{for=\"parse\"}";

/// Somebody else at the database of a server.
async fn connected(server: &Server) -> SqliteConnection {
    let file = server.path().join("facies.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file);
    SqliteConnection::connect_with(&options).await.unwrap()
}

/// Keeps everybody from writing to the database of a server.
async fn locked(server: &Server) -> SqliteConnection {
    let mut connection = connected(server).await;
    sqlx::raw_sql("BEGIN IMMEDIATE").execute(&mut connection).await.unwrap();
    connection
}

async fn unlock(mut writer: SqliteConnection) {
    sqlx::raw_sql("COMMIT").execute(&mut writer).await.unwrap();
}

/// The outcomes of an action in the log of a tenant.
async fn outcomes(hospital: &Hospital, key: &str, action: &str) -> Vec<String> {
    let log = hospital.get(key, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let rows = log["items"].as_array().unwrap().iter();
    let own = rows.filter(|row| row["action"] == action);
    own.map(|row| row["outcome"].as_str().unwrap().to_owned()).collect()
}

/// A case of the tenant, and a plan for it.
async fn case(hospital: &Hospital, key: &str) -> String {
    let form = hospital.server.post("/v1/cases").bearer_auth(key);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    format!("/v1/cases/{}/plans", case["id"].as_str().unwrap())
}

fn plan(x: usize) -> Value {
    json!({"segments": [{"name": "bone", "translation_mm": [x, 0, 0]}]})
}

#[tokio::test]
async fn a_body_that_breaks_off_is_not_noted_and_waits_for_nobody() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["write", "admin"]).await;
    let head = format!(
        "POST /v1/meshes HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer {key}\r\n\
         Content-Type: model/stl\r\nContent-Length: 1000\r\n\r\nsolid"
    );
    let writer = locked(&hospital.server).await;
    let is_over = is_quick(LESS_THAN_A_WRITER_WAITS, async || {
        for _ in 0..50 {
            drop(send(&hospital.server, &head).await);
        }
        until("they are over", async || {
            // The one that asks is under way on the other listener.
            (hospital.metric(UNDER_WAY).await == 0.0).then_some(())
        })
        .await;
    });
    assert!(is_over.await, "they wait for those who write");
    unlock(writer).await;
    assert_eq!(outcomes(&hospital, &key, "POST /v1/meshes").await, [""; 0]);
}

#[tokio::test]
async fn who_may_not_write_is_told_so_without_waiting_for_those_who_write() {
    let hospital = Hospital::open();
    let reader = hospital.key("a", &["read", "admin"]).await;
    let writer = locked(&hospital.server).await;
    let begun = Instant::now();
    for _ in 0..20 {
        let refused = hospital.post(&reader, "/v1/jobs", &json!({})).await;
        refused.problem(403, "forbidden-scope");
    }
    assert!(begun.elapsed() < 20 * LESS_THAN_A_WRITER_WAITS, "{:?}", begun.elapsed());
    unlock(writer).await;
    assert_eq!(outcomes(&hospital, &reader, "POST /v1/jobs").await, ["403"; 20]);
}

#[tokio::test]
async fn a_body_that_says_nothing_of_use_is_answered_without_waiting_and_noted_with_its_answer() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["run", "admin"]).await;
    let writer = locked(&hospital.server).await;
    // Who waits to write is told 503 in the end.
    hospital
        .post(&key, "/v1/jobs", &json!({"kind": "predict"}))
        .await
        .problem(422, "validation-failed");
    unlock(writer).await;
    assert_eq!(outcomes(&hospital, &key, "POST /v1/jobs").await, ["422"]);
}

/// Of two who wait to write the second leaves. False where the first was told that it took too long.
async fn the_second_leaves(hospital: &Hospital, key: &str, plans: &str) -> bool {
    let post =
        |x: usize| tokio::spawn(ask(hospital.server.post(plans).bearer_auth(key).json(&plan(x))));
    // An answer may be here before its request is over there.
    until("nothing is under way", async || (hospital.metric(UNDER_WAY).await == 0.0).then_some(()))
        .await;
    let writer = locked(&hospital.server).await;
    let first = post(1);
    let under_way = async |most: f64| {
        until("they are under way, or the first has waited too long", async || {
            (first.is_finished() || hospital.metric(UNDER_WAY).await == most).then_some(())
        })
        .await;
    };
    under_way(1.0).await;
    let second = post(2);
    under_way(2.0).await;
    second.abort();
    under_way(1.0).await;
    unlock(writer).await;
    let first = first.await.unwrap();
    post(3).await.unwrap().expect(StatusCode::CREATED);
    first.status == StatusCode::CREATED
}

#[tokio::test]
async fn who_leaves_while_he_waits_to_write_leaves_no_note_behind() {
    for _ in 0..5 {
        let hospital = Hospital::open();
        let key = hospital.key("a", &["read", "write", "run", "admin"]).await;
        let plans = case(&hospital, &key).await;
        if !the_second_leaves(&hospital, &key, &plans).await {
            continue;
        }
        let mut database = connected(&hospital.server).await;
        until("each that was noted has ended", async || {
            let open = sqlx::query_scalar("SELECT COUNT(*) FROM deeds WHERE outcome IS NULL");
            let open: i64 = open.fetch_one(&mut database).await.unwrap();
            (open == 0).then_some(())
        })
        .await;
        let kept = hospital.get(&key, &plans).await.expect(StatusCode::OK);
        let kept = kept["items"].as_array().unwrap().len();
        let noted = outcomes(&hospital, &key, "POST /v1/cases/{id}/plans").await;
        assert_eq!(noted, vec!["201"; kept]);
        // On a busy machine both may have been noted at once, and then the second had begun.
        if kept == 2 {
            return;
        }
    }
    panic!("who left was never given up");
}

#[tokio::test]
async fn who_leaves_while_he_waits_for_the_parser_gives_up_his_place_and_his_bytes() {
    const LARGE: Block = Block { cells: [44, 44, 30] };
    const UPLOADS: usize = 20;
    let hospital = Hospital::open();
    let key = hospital.key("a", &["read", "write", "admin"]).await;
    let bytes = LARGE.vtu();
    let uploads: Vec<_> = (0..UPLOADS)
        .map(|number| {
            let request = hospital.server.post("/v1/meshes?allow_any_scale=true").bearer_auth(&key);
            let body = [&bytes[..], &vec![b'\n'; number]].concat();
            tokio::spawn(ask(request.header("content-type", "application/octet-stream").body(body)))
        })
        .collect();
    until("they wait", async || (hospital.metric(PARSE).await > 10.0).then_some(())).await;
    let done = outcomes(&hospital, &key, "POST /v1/meshes").await.len();
    for upload in &uploads {
        upload.abort();
    }
    until("their bytes are given back", async || {
        (hospital.metric(BODIES).await == 0.0).then_some(())
    })
    .await;
    let after = outcomes(&hospital, &key, "POST /v1/meshes").await.len();
    // Those that were read at that moment may be there.
    assert!(after <= done + 4, "{done} and then {after} of {UPLOADS}");
}

#[tokio::test]
async fn who_leaves_while_he_waits_for_his_job_is_not_waited_for() {
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &["--workers", "0"]);
    let key = hospital.key("a", &["read", "write", "run", "admin"]).await;
    let plans = case(&hospital, &key).await;
    let case = plans.split('/').nth(3).unwrap();
    let job = hospital.server.post("/v1/jobs").bearer_auth(&key).header("prefer", "wait=30");
    let begun = Instant::now();
    let waiting = tokio::spawn(ask(job.json(&spec(case, 1.0))));
    until("it is accepted", async || {
        let jobs = hospital.get(&key, "/v1/jobs").await.expect(StatusCode::OK);
        (jobs["items"].as_array().unwrap().len() == 1).then_some(())
    })
    .await;
    waiting.abort();
    until("it is noted", async || {
        (outcomes(&hospital, &key, "POST /v1/jobs").await == ["201"]).then_some(())
    })
    .await;
    assert!(begun.elapsed() < Duration::from_secs(25), "{:?}", begun.elapsed());
}

#[tokio::test]
async fn a_tenant_that_writes_much_is_waited_for_once_and_not_each_time() {
    // Few enough to be there before the first has waited too long, on any machine.
    const MANY: usize = 16;
    let hospital = Hospital::open();
    let all = ["read", "write", "run", "admin"];
    let (greedy, modest) = (hospital.key("a", &all).await, hospital.key("b", &all).await);
    let (greedy_plans, modest_plans) =
        (case(&hospital, &greedy).await, case(&hospital, &modest).await);
    let post = |key: &str, path: &str, x: usize| {
        tokio::spawn(ask(hospital.server.post(path).bearer_auth(key).json(&plan(x))))
    };
    let writer = locked(&hospital.server).await;
    let many: Vec<_> = (0..MANY).map(|x| post(&greedy, &greedy_plans, x)).collect();
    until("they wait", async || (hospital.metric(UNDER_WAY).await >= MANY as f64).then_some(()))
        .await;
    let one = post(&modest, &modest_plans, 1);
    until("it waits as well", async || {
        (hospital.metric(UNDER_WAY).await > MANY as f64).then_some(())
    })
    .await;
    unlock(writer).await;
    one.await.unwrap().expect(StatusCode::CREATED);
    let done = many.iter().filter(|posted| posted.is_finished()).count();
    assert!(done < MANY / 2, "{done} of {MANY} went first");
    for posted in many {
        posted.await.unwrap().expect(StatusCode::CREATED);
    }
    assert_eq!(outcomes(&hospital, &greedy, "POST /v1/cases/{id}/plans").await.len(), MANY);
}

#[tokio::test]
async fn a_tenant_of_whom_many_wait_to_write_is_told_to_come_back_and_no_other() {
    let settings = ["--waiting-requests", "2"];
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &settings);
    let all = ["read", "write", "run", "admin"];
    let (greedy, modest) = (hospital.key("a", &all).await, hospital.key("b", &all).await);
    let (greedy_plans, modest_plans) =
        (case(&hospital, &greedy).await, case(&hospital, &modest).await);
    let post = |key: &str, path: &str, x: usize| {
        tokio::spawn(ask(hospital.server.post(path).bearer_auth(key).json(&plan(x))))
    };
    let writer = locked(&hospital.server).await;
    let many: Vec<_> = (0..10).map(|x| post(&greedy, &greedy_plans, x)).collect();
    until("some are refused", async || {
        many.iter().any(|posted| posted.is_finished()).then_some(())
    })
    .await;
    let one = post(&modest, &modest_plans, 1);
    let mut refused = 0;
    unlock(writer).await;
    for posted in many {
        let answer = posted.await.unwrap();
        if answer.status != StatusCode::CREATED {
            assert_eq!(answer.problem(503, "busy")["limit"], 2);
            refused += 1;
        }
    }
    assert!((1..10).contains(&refused), "{refused}");
    one.await.unwrap().expect(StatusCode::CREATED);
    // What was not done for want of an answer is not noted.
    let noted = outcomes(&hospital, &greedy, "POST /v1/cases/{id}/plans").await;
    assert_eq!(noted, vec!["201"; 10 - refused]);
}
