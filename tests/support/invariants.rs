//! What holds whatever died: I1 every accepted job comes to one end, I2 a success has all its files with the hashes it
//! promises, I3 no result is visible before its job is successful, I4 the result has the bits of an undisturbed run, I7
//! no job has more attempts than it may have.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};

use facies::schema::wire::canonical::sha256_hex;
use reqwest::StatusCode;
use serde_json::Value;

use crate::helpers::{Answer, Block, SMALL, Server, ask, spec};

/// Iterated and not factorised, in well below a second.
pub const MEDIUM: Block = Block { cells: [16, 16, 10] };
const MOST_ATTEMPTS: i64 = 3;

/// A prediction with a tag that a fault may ask for.
pub fn tagged(case: &str, x: f64, tag: &str) -> Value {
    let mut spec = spec(case, x);
    spec["tags"] = serde_json::json!([tag]);
    spec
}

pub async fn accepted(server: &Server, spec: &Value) -> String {
    let job = ask(server.post("/v1/jobs").json(spec)).await.expect(StatusCode::CREATED);
    job["id"].as_str().unwrap().to_owned()
}

pub async fn state(server: &Server, id: &str) -> Value {
    ask(server.get(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK)
}

async fn results(server: &Server, id: &str) -> Answer {
    ask(server.get(&format!("/v1/jobs/{id}/results"))).await
}

/// I3, for a job that has not ended.
pub async fn shows_no_result(server: &Server, id: &str) {
    results(server, id).await.problem(404, "result-not-ready");
    ask(server.get(&format!("/v1/jobs/{id}/results/skin.vtp")))
        .await
        .problem(404, "result-not-ready");
}

/// The state of a job that has to be successful in this attempt, with I1, I2 and I7.
pub async fn succeeds(server: &Server, id: &str, attempt: i64) -> Value {
    let job = ends(server, id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&"successful".into(), &attempt.into()), "{job}");
    for file in job["results"]["files"].as_array().unwrap() {
        let name = file["name"].as_str().unwrap();
        let answer = ask(server.get(&format!("/v1/jobs/{id}/results/{name}"))).await;
        answer.expect_bytes(name);
        assert_eq!(sha256_hex(&answer.bytes), file["sha256"].as_str().unwrap(), "{name}");
    }
    job
}

/// The error of a job that has to fail in this attempt, with I1 and I7.
pub async fn fails(server: &Server, id: &str, attempt: i64) -> Value {
    let job = ends(server, id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&"failed".into(), &attempt.into()), "{job}");
    job["error"].clone()
}

/// The end of a job: it stays what it is, and is there once.
async fn ends(server: &Server, id: &str) -> Value {
    let job = server.ended(id).await;
    assert!(job["attempt"].as_i64().unwrap() <= MOST_ATTEMPTS, "{job}");
    let listed = ask(server.get("/v1/jobs?limit=200")).await.expect(StatusCode::OK);
    let same = listed["items"].as_array().unwrap().iter().filter(|item| item["id"] == id);
    assert_eq!(same.count(), 1);
    assert_eq!(state(server, id).await["status"], job["status"]);
    job
}

impl Answer {
    fn expect_bytes(&self, name: &str) {
        assert_eq!(self.status, StatusCode::OK, "{name}");
    }
}

/// I4: the files of the block moved by `x` on a server that nothing happens to, without the manifest, which has times.
pub async fn undisturbed(block: &Block, x: f64) -> BTreeMap<String, String> {
    let server = Server::start();
    let case = server.case(block).await;
    let id = accepted(&server, &spec(&case, x)).await;
    files(&succeeds(&server, &id, 1).await)
}

/// The hashes of the files of a job by their names, without the manifest.
pub fn files(job: &Value) -> BTreeMap<String, String> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let files = job["results"]["files"].as_array().unwrap().iter();
    let files = files.map(|file| (text(&file["name"]), text(&file["sha256"])));
    files.filter(|(name, _)| name != "result.json").collect()
}

/// The service takes a job and solves it at once.
pub async fn works_on(server: &Server) {
    assert_eq!(ask(server.get("/readyz")).await.expect(StatusCode::OK)["status"], "ok");
    let case = server.case(&SMALL).await;
    // What was asked for before would be known.
    static TIMES: AtomicU32 = AtomicU32::new(0);
    let x = 0.123 + f64::from(TIMES.fetch_add(1, Ordering::Relaxed)) / 1e4;
    let job = ask(server.post("/v1/jobs").json(&spec(&case, x))).await;
    // 200 if it has already ended when its state is read for the response.
    assert!([StatusCode::CREATED, StatusCode::OK].contains(&job.status), "{:?}", job.json());
    succeeds(server, job.json()["id"].as_str().unwrap(), 1).await;
}

/// Told to come back; otherwise it is answered.
pub fn is_shed(answer: &Answer) -> bool {
    if answer.status == StatusCode::OK {
        return false;
    }
    answer.problem(503, "not-ready");
    assert!(!answer.header("retry-after").is_empty());
    true
}
