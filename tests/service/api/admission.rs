//! What a job is expected to take, and what becomes of one that is expected to take too much.

use reqwest::StatusCode;
use serde_json::json;

use crate::helpers::{Block, SMALL, Server, ask, spec};

/// Its matrix alone takes more than the smallest slot has.
const WIDE: Block = Block { cells: [24, 24, 20] };
const SMALLEST: [&str; 4] = ["--slot-memory-mib", "64", "--workers", "1"];
const SMALLEST_MB: f64 = 67.108864;

#[tokio::test]
async fn a_job_that_needs_more_memory_than_a_slot_has_is_refused_with_the_numbers() {
    let server = Server::start_with(&SMALLEST);
    let limits = ask(server.get("/v1/limits")).await.expect(StatusCode::OK);
    assert_eq!(limits["slot_memory_mb"], SMALLEST_MB);
    let case = server.case(&WIDE).await;
    let check = ask(server.post(&format!("/v1/cases/{case}/check")).json(&json!({}))).await;
    let check = check.expect(StatusCode::OK);
    let response = json!({"kind": "response", "case": case});
    for job in [spec(&case, 1.0), response] {
        let problem = server.job(&job).await.problem(422, "budget-exceeded");
        assert_eq!(
            (&problem["which"], &problem["allowed_mb"]),
            (&"memory".into(), &SMALLEST_MB.into())
        );
        assert!(problem["needed_mb"].as_f64() >= check["memory_mb"].as_f64(), "{problem}");
    }
    let small = server.case(&SMALL).await;
    server.job(&spec(&small, 1.0)).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_job_accepted_for_larger_slots_fails_with_the_same_numbers() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&WIDE).await;
    let job = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    let id = job.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let (folder, _) = server.terminate();
    let server = Server::start_in(folder, &SMALLEST);
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&"failed".into(), &1.into()));
    let error = &job["error"];
    assert_eq!((&error["type"], &error["class"]), (&"budget-exceeded".into(), &"budget".into()));
    assert_eq!(error["allowed_mb"], SMALLEST_MB);
}

#[tokio::test]
async fn a_check_tells_what_a_job_will_take() {
    let server = Server::start();
    let case = server.case(&WIDE).await;
    let address = format!("/v1/cases/{case}/check");
    let check = ask(server.post(&address).json(&json!({}))).await.expect(StatusCode::OK);
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let provenance = &job["results"]["provenance"];
    assert_eq!(check["unknowns"], provenance["solver"]["unknowns"]);
    assert_eq!(check["method"], provenance["method"]);
    // The estimate was within a third where it was measured; other allocators differ.
    let (expected, peak) = (&check["memory_mb"], &provenance["peak_rss_mb"]);
    let ratio = peak.as_f64().unwrap() / expected.as_f64().unwrap();
    assert!((0.5..2.0).contains(&ratio), "{expected} {peak}");
    let time = &check["time_s"];
    assert!(0.0 < time["low"].as_f64().unwrap() && time["low"].as_f64() < time["high"].as_f64());
    let warp = json!({"method": "thickness_warp"});
    let check = ask(server.post(&address).json(&warp)).await.expect(StatusCode::OK);
    assert!(check.get("time_s").is_none(), "it has no unknowns of the mesh: {check}");
}
