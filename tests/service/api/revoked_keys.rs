//! A key that is revoked while its request waits, or while its stream is open, is told nothing more.

use std::time::Duration;

use futures::StreamExt as _;
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::tenants::Hospital;
use crate::helpers::{SMALL, ask, read, spec};
use crate::processes::until;

const ALL: [&str; 4] = ["read", "write", "run", "admin"];

/// A service without workers, whose jobs end when they are dismissed, and a case of a tenant.
struct Queue {
    hospital: Hospital,
    owner: String,
    case: String,
}

impl Queue {
    async fn open() -> Queue {
        let hospital = Hospital::open_with(TempDir::new().unwrap(), &["--workers", "0"]);
        let owner = hospital.key("a", &ALL).await;
        let form = hospital.server.post("/v1/cases").bearer_auth(&owner);
        let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await;
        let case = case.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
        Queue { hospital, owner, case }
    }

    async fn job(&self, x: f64) -> String {
        let accepted = self.hospital.post(&self.owner, "/v1/jobs", &spec(&self.case, x)).await;
        accepted.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
    }

    async fn revoke(&self, key: &str) {
        let path = format!("/tenants/a/keys/{}", key.split('_').nth(1).unwrap());
        let revoked = ask(self.hospital.admin(Method::DELETE, &path)).await;
        assert_eq!(revoked.status, StatusCode::NO_CONTENT);
    }

    async fn dismiss(&self, job: &str) {
        let dismiss = self.hospital.server.delete(&format!("/v1/jobs/{job}"));
        ask(dismiss.bearer_auth(&self.owner)).await.expect(StatusCode::OK);
    }

    /// Until so many requests are worked on.
    async fn at_work(&self, count: f64) {
        until("the requests arrive", async || {
            let at_work = self.hospital.metric("facies_http_requests_in_flight").await;
            (at_work == count).then_some(())
        })
        .await;
    }
}

#[tokio::test]
async fn a_request_whose_key_is_revoked_while_it_waits_is_refused() {
    let queue = Queue::open().await;
    let (job, server) = (queue.job(1.0).await, &queue.hospital.server);
    let reader = queue.hospital.key("a", &["read"]).await;
    let path = format!("/v1/jobs/{job}");
    let paths = [path.clone(), format!("{path}/results"), format!("{path}/results/skin.vtp")];
    let waiting = |path: &String| {
        let request = server.get(path).bearer_auth(&reader).header("prefer", "wait=30");
        tokio::spawn(request.send())
    };
    let waiting = paths.each_ref().map(waiting);
    queue.at_work(3.0).await;
    queue.revoke(&reader).await;
    queue.dismiss(&job).await;
    for request in waiting {
        read(request.await.unwrap().unwrap()).await.problem(401, "unauthorized");
    }
}

#[tokio::test]
async fn a_job_whose_key_is_revoked_while_it_is_waited_for_is_in_the_log_and_not_in_the_answer() {
    let queue = Queue::open().await;
    let (hospital, server) = (&queue.hospital, &queue.hospital.server);
    let runner = hospital.key("a", &["run"]).await;
    let request = server.post("/v1/jobs").bearer_auth(&runner).header("prefer", "wait=30");
    let waiting = tokio::spawn(request.json(&spec(&queue.case, 1.0)).send());
    let job = until("the job is accepted", async || {
        let jobs = hospital.get(&queue.owner, "/v1/jobs").await.expect(StatusCode::OK);
        jobs["items"][0]["id"].as_str().map(str::to_owned)
    })
    .await;
    queue.revoke(&runner).await;
    queue.dismiss(&job).await;
    read(waiting.await.unwrap().unwrap()).await.problem(401, "unauthorized");
    let log = hospital.get(&queue.owner, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let of_job = |row: &&Value| row["action"] == "POST /v1/jobs";
    let row = log["items"].as_array().unwrap().iter().find(of_job).unwrap();
    assert_eq!((&row["object"], &row["outcome"]), (&json!(job), &json!("201")), "{row}");
}

#[tokio::test]
async fn a_stream_of_events_ends_when_its_key_is_revoked() {
    let queue = Queue::open().await;
    let job = queue.job(1.0).await;
    let reader = queue.hospital.key("a", &["read"]).await;
    let path = format!("/v1/jobs/{job}/events");
    let stream = queue.hospital.server.get(&path).bearer_auth(&reader).send().await.unwrap();
    let mut stream = stream.bytes_stream();
    assert!(stream.next().await.unwrap().is_ok());
    queue.revoke(&reader).await;
    let rest = tokio::time::timeout(Duration::from_secs(60), stream.collect::<Vec<_>>()).await;
    let rest: Vec<_> = rest.expect("it ends").into_iter().map(Result::unwrap).collect();
    let rest = String::from_utf8(rest.concat()).unwrap();
    assert!(!rest.contains("event: end"), "{rest}");
    queue.hospital.get(&reader, &path).await.problem(401, "unauthorized");
}

#[tokio::test]
async fn a_key_that_ends_itself_is_answered() {
    let queue = Queue::open().await;
    let id = queue.owner.split('_').nth(1).unwrap();
    let path = format!("/v1/keys/{id}/rotation");
    let request = queue.hospital.server.post(&path).bearer_auth(&queue.owner);
    let rotation = request.header("prefer", "wait=1").json(&json!({"overlap_h": 0}));
    let made = ask(rotation).await.expect(StatusCode::CREATED);
    queue.hospital.get(&queue.owner, "/v1/keys").await.problem(401, "unauthorized");
    queue.hospital.get(made["key"].as_str().unwrap(), "/v1/keys").await.expect(StatusCode::OK);
}
