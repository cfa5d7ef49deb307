//! What clients and those who run the service are told beside the answers: what is left, what has changed,
//! what was counted.

use reqwest::StatusCode;
use sqlx::{Connection as _, SqliteConnection};

use crate::helpers::{SMALL, Server, ask, spec};
use crate::processes::until;

#[tokio::test]
async fn a_client_that_asks_too_often_gets_retry_after() {
    let server = Server::start_with(&["--requests-per-minute", "3"]);
    for left in [2, 1, 0] {
        let answer = ask(server.get("/v1/limits")).await;
        assert_eq!(answer.expect(StatusCode::OK)["requests_per_minute"], 3);
        assert_eq!(answer.header("ratelimit-policy"), "\"requests\";q=3;w=60");
        let told = answer.header("ratelimit");
        assert!(told.starts_with(&format!("\"requests\";r={left};t=")), "{told}");
    }
    let refused = ask(server.get("/v1/limits")).await;
    assert_eq!(refused.problem(429, "rate-limited")["limit"], 3);
    let seconds: u64 = refused.header("retry-after").parse().unwrap();
    assert!((1..=21).contains(&seconds), "{seconds}");
    assert_eq!(refused.header("ratelimit-policy"), "\"requests\";q=3;w=60");
    assert!(refused.header("ratelimit").starts_with("\"requests\";r=0;t="));
    // Probes are not counted.
    ask(server.get("/healthz")).await.expect(StatusCode::OK);
    let unbounded = Server::start_with(&["--requests-per-minute", "0"]);
    assert_eq!(ask(unbounded.get("/v1/limits")).await.header("ratelimit"), "");
}

#[tokio::test]
async fn the_state_of_a_job_has_a_tag_and_is_not_sent_twice() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await.json();
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    // One call waits for the end and brings the results.
    let results = ask(server.get(&format!("{path}/results")).header("prefer", "wait=30")).await;
    results.expect(StatusCode::OK);
    let known = |path: String, tag: String| server.get(&path).header("if-none-match", tag);
    for path in [path.clone(), format!("{path}/results")] {
        let seen = ask(server.get(&path)).await;
        let tag = seen.header("etag").to_owned();
        assert!(tag.len() > 60, "{tag}");
        let again = ask(known(path.clone(), tag)).await;
        assert_eq!((again.status, again.bytes.len()), (StatusCode::NOT_MODIFIED, 0));
        ask(known(path, "\"other\"".into())).await.expect(StatusCode::OK);
    }
}

#[tokio::test]
async fn what_was_counted_is_reported_on_a_listener_of_its_own() {
    let mut server = Server::start_with(&["--admin-bind", "127.0.0.1:0"]);
    let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    ask(server.get(&format!("/v1/jobs/{}", job["id"].as_str().unwrap()))).await;
    ask(server.get("/v1/jobs/nothing")).await;
    ask(server.get("/nothing")).await;
    ask(server.get("/metrics")).await.problem(404, "not-found");
    let beside = metrics.replace("/metrics", "/nothing");
    ask(server.client.get(beside)).await.problem(404, "not-found");

    let answer = until("the attempt is counted, after its result is there for all", async || {
        let answer = ask(server.client.get(&metrics)).await;
        let counted = "facies_attempts_total{kind=\"predict\",status=\"successful\"} 1";
        String::from_utf8_lossy(&answer.bytes).contains(counted).then_some(answer)
    })
    .await;
    assert!(answer.header("content-type").starts_with("text/plain; version=0.0.4"));
    let text = String::from_utf8(answer.bytes).unwrap();
    let requests = |route: &str, method: &str, status: &str| {
        format!(
            "facies_http_requests_total{{route=\"{route}\",method=\"{method}\",status=\"{status}\"}} "
        )
    };
    for line in [
        requests("/v1/cases", "POST", "2xx"),
        requests("/v1/jobs/{id}", "GET", "2xx"),
        requests("/v1/jobs/{id}", "GET", "4xx"),
        requests("unmatched", "GET", "4xx"),
        "facies_http_request_seconds_bucket{route=\"/v1/jobs\",method=\"POST\",le=\"30\"} 1".into(),
        "facies_http_requests_in_flight 0".into(),
        "facies_queue_jobs{state=\"waiting\"} ".into(),
    ] {
        assert!(text.contains(&line), "{line} is not in {text}");
    }
    assert!(!text.contains(job["id"].as_str().unwrap()), "no id becomes a label");
    let root = metrics.trim_end_matches("/metrics");
    let jobs = ask(server.client.get(format!("{root}/v1/jobs"))).await;
    assert_eq!(jobs.status, StatusCode::NOT_FOUND, "clients are answered elsewhere");
}

#[tokio::test]
async fn a_queue_that_the_database_does_not_tell_is_left_out() {
    let mut server = Server::start_with(&["--admin-bind", "127.0.0.1:0"]);
    let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
    let told = async || String::from_utf8(ask(server.client.get(&metrics)).await.bytes).unwrap();
    let options =
        sqlx::sqlite::SqliteConnectOptions::new().filename(server.path().join("facies.db"));
    let mut other = SqliteConnection::connect_with(&options).await.unwrap();
    for (sql, up) in [
        ("SELECT 1", true),
        ("ALTER TABLE jobs RENAME TO jobs_elsewhere", false),
        ("ALTER TABLE jobs_elsewhere RENAME TO jobs", true),
    ] {
        sqlx::raw_sql(sql).execute(&mut other).await.unwrap();
        let text = told().await;
        assert!(text.contains(&format!("facies_database_up {}\n", u8::from(up))), "{sql}: {text}");
        assert_eq!(text.contains("facies_queue_oldest_seconds 0\n"), up, "{sql}: {text}");
        assert_eq!(text.contains("facies_queue"), up, "{sql}: {text}");
    }
}
