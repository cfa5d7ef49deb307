//! Events of jobs: all of them, once, also for those who were away.

use std::time::Duration;

use futures::StreamExt as _;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Block, SMALL, Server, ask, spec};
use crate::processes::until;

/// An event as a browser would see it.
#[derive(Clone, Debug, PartialEq)]
struct Event {
    name: String,
    id: u64,
    data: Value,
}

/// The events of a text, without comments and settings of the stream.
fn events(text: &str) -> Vec<Event> {
    let field = |block: &str, name: &str| {
        block.lines().find_map(|line| line.strip_prefix(name)).map(|value| value.trim().to_owned())
    };
    let event = |block: &str| {
        Some(Event {
            name: field(block, "event:")?,
            id: field(block, "id:")?.parse().unwrap(),
            data: serde_json::from_str(&field(block, "data:")?).unwrap(),
        })
    };
    text.split("\n\n").filter_map(event).collect()
}

async fn followed(server: &Server, job: &str, after: Option<u64>) -> Vec<Event> {
    let mut request = server.get(&format!("/v1/jobs/{job}/events"));
    if let Some(after) = after {
        request = request.header("last-event-id", after.to_string());
    }
    let answer = ask(request).await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "text/event-stream");
    let text = String::from_utf8(answer.bytes).unwrap();
    assert!(text.contains("retry: 2000") || text.contains("retry:2000"), "{text}");
    events(&text)
}

/// A study that runs until it is dismissed.
fn long() -> Value {
    json!({
        "kind": "study", "scenes": ["slab"], "methods": ["fem_linear"], "levels": [0, 1, 2, 3],
        "repeats": 20,
    })
}

#[tokio::test]
async fn a_stream_tells_every_state_of_a_job_and_ends_with_it() {
    let server = Server::start();
    let case = server.case(&Block { cells: [12, 12, 12] }).await;
    let job = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    let job = job.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let told = followed(&server, &job, None).await;
    let numbers: Vec<u64> = told.iter().map(|event| event.id).collect();
    assert_eq!(numbers, (1..=told.len() as u64).collect::<Vec<_>>(), "no number is missing");
    assert_eq!((told[0].name.as_str(), &told[0].data["status"]), ("state", &json!("accepted")));
    assert_eq!((&told[1].data["status"], &told[1].data["attempt"]), (&json!("running"), &json!(1)));
    let last = told.last().unwrap();
    assert_eq!((last.name.as_str(), &last.data["status"]), ("end", &json!("successful")));
    assert_eq!(last.data["progress"], 100);
    let progress: Vec<u64> =
        told.iter().map(|event| event.data["progress"].as_u64().unwrap()).collect();
    assert!(progress.is_sorted(), "{progress:?}");

    // Whoever comes back with any of the ids gets the rest, and with the last one nothing.
    for away in 1..told.len() {
        assert_eq!(followed(&server, &job, Some(away as u64)).await, told[away..]);
    }
    let all = server.get(&format!("/v1/jobs/{job}/events")).header("last-event-id", last.id);
    assert_eq!(ask(all).await.status, StatusCode::NO_CONTENT);
}

#[tokio::test]
async fn what_happens_while_a_client_or_the_service_is_away_is_reported_later() {
    let server = Server::start_with(&["--workers", "1"]);
    let job = ask(server.post("/v1/jobs").json(&long())).await.expect(StatusCode::CREATED);
    let id = job["id"].as_str().unwrap().to_owned();
    assert_eq!(server.started(&id).await["status"], "running");
    let folder = server.kill();
    let server = Server::start_in(folder, &["--workers", "1"]);
    let path = format!("/v1/jobs/{id}");
    until("the second attempt begins", async || {
        (ask(server.get(&path)).await.json()["attempt"] == 2).then_some(())
    })
    .await;
    ask(server.delete(&path)).await.expect(StatusCode::OK);
    let told = followed(&server, &id, None).await;
    let states = |wanted: &str| {
        let of = |event: &&Event| event.name == "state" && event.data["status"] == wanted;
        told.iter().filter(of).map(|event| event.data["attempt"].as_u64().unwrap()).collect()
    };
    let accepted: Vec<u64> = states("accepted");
    let running: Vec<u64> = states("running");
    assert_eq!((accepted, running), (vec![0, 1], vec![1, 2]), "{told:?}");
    assert_eq!(told.last().unwrap().data["status"], "dismissed");
    // Removed, its events are gone with it.
    assert_eq!(ask(server.delete(&path)).await.status, StatusCode::NO_CONTENT);
    ask(server.get(&format!("{path}/events"))).await.problem(410, "gone");
}

#[tokio::test]
async fn open_streams_are_counted_for_each_client_and_end_with_their_job() {
    let server = Server::start_with(&["--workers", "0", "--event-streams", "2"]);
    let job = ask(server.post("/v1/jobs").json(&long())).await.expect(StatusCode::CREATED);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let stream = format!("{path}/events");
    let open = || async { server.get(&stream).send().await.unwrap() };
    let (first, second) = (open().await, open().await);
    assert_eq!((first.status(), second.status()), (StatusCode::OK, StatusCode::OK));
    let refused = ask(server.get(&stream)).await;
    assert_eq!(refused.problem(429, "too-many-streams")["limit"], 2);
    assert!(!refused.header("retry-after").is_empty());
    drop(second);
    // The place is free as soon as the service notices.
    let again = until("a place is free", async || {
        let answer = open().await;
        (answer.status() == StatusCode::OK).then_some(answer)
    })
    .await;
    ask(server.delete(&path)).await.expect(StatusCode::OK);
    for stream in [first, again] {
        let text = stream.text().await.unwrap();
        assert_eq!(events(&text).last().unwrap().name, "end", "{text}");
    }
}

#[tokio::test]
async fn neither_streams_nor_waits_keep_the_service_from_stopping() {
    let server = Server::start_with(&["--workers", "0", "--grace-s", "60"]);
    let job = ask(server.post("/v1/jobs").json(&long())).await.expect(StatusCode::CREATED);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let stream = server.get(&format!("{path}/events")).send().await.unwrap();
    let mut stream = stream.bytes_stream();
    assert!(stream.next().await.unwrap().is_ok());
    let wait = tokio::spawn(server.get(&path).header("prefer", "wait=30").send());
    let rest = tokio::spawn(async move { stream.all(async |piece| piece.is_ok()).await });
    let most = Duration::from_secs(20);
    let ended = tokio::task::spawn_blocking(move || server.terminate_within(most));
    assert!(ended.await.unwrap(), "it took longer than 20 s");
    assert!(rest.await.unwrap(), "the stream was ended and did not break");
    // The request that waited is answered, unless it came after the last one.
    if let Ok(answer) = wait.await.unwrap() {
        assert_eq!(answer.status(), StatusCode::OK);
    }
}

#[tokio::test]
async fn what_is_no_stream_and_no_id_is_refused() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.json();
    let path = format!("/v1/jobs/{}/events", job["id"].as_str().unwrap());
    let html = server.get(&path).header("accept", "text/html");
    ask(html).await.problem(406, "not-acceptable");
    for wrong in ["x", "-1", "1.5", "99999999999999999999"] {
        let request = server.get(&path).header("last-event-id", wrong);
        assert_eq!(
            ask(request).await.problem(400, "invalid-parameter")["parameter"],
            "Last-Event-ID"
        );
    }
    let nobody = format!("/v1/jobs/{}/events", uuid::Uuid::now_v7());
    ask(server.get(&nobody)).await.problem(404, "no-such-job");
}
