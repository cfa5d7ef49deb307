//! The examples of the description: one for every JSON body, each of which the service takes.

use reqwest::StatusCode;
use serde_json::Value;

use crate::helpers::{Server, ask};
use crate::samples::{BONE_BALL, SKIN_BALL, ball_ct, ball_stl};

/// The bodies of an operation by the names of their examples.
fn examples(operation: &str) -> Vec<(String, Value)> {
    let document = facies::api::document();
    let items = document["paths"].as_object().unwrap().values();
    let operations = items.flat_map(|item| item.as_object().unwrap().values());
    let described = operations.into_iter().find(|found| found["operationId"] == operation).unwrap();
    let named = &described["requestBody"]["content"]["application/json"]["examples"];
    let named = named.as_object().unwrap().iter();
    named.map(|(name, example)| (name.clone(), example["value"].clone())).collect()
}

/// A body with ids that are there in the place of those of the examples.
fn with_ids(body: &Value, ids: &[(&str, &str)]) -> Value {
    let text = body.to_string();
    let text = ids.iter().fold(text, |text, (example, id)| text.replace(example, id));
    assert!(!text.contains("0199d3a0-0000"), "an id without a meaning: {text}");
    serde_json::from_str(&text).unwrap()
}

fn id(number: u32) -> String {
    format!("0199d3a0-0000-7000-8000-{number:012}")
}

fn file(name: &str) -> Vec<u8> {
    let block = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/block");
    std::fs::read(block.join(name)).unwrap()
}

#[test]
fn every_json_body_in_the_description_has_an_example() {
    let document = facies::api::document();
    let mut seen = 0;
    for (path, item) in document["paths"].as_object().unwrap() {
        for operation in item.as_object().unwrap().values() {
            let content = &operation["requestBody"]["content"]["application/json"];
            if content.is_null() {
                continue;
            }
            let examples = content["examples"].as_object();
            assert!(examples.is_some_and(|examples| !examples.is_empty()), "{path}");
            seen += 1;
        }
    }
    assert!(seen >= 8, "{seen}");
}

#[test]
fn there_is_an_example_of_a_job_of_each_kind() {
    let kinds: Vec<Value> =
        examples("create_job").iter().map(|(_, job)| job["kind"].clone()).collect();
    for kind in facies::schema::job_document::JobKind::ALL {
        assert!(kinds.contains(&kind.name().into()), "{}", kind.name());
    }
}

async fn takes_keys(server: &Server) {
    let mut key = String::new();
    for (name, body) in examples("create_key") {
        let answer = ask(server.post("/v1/keys").json(&body)).await;
        assert_eq!(answer.status, StatusCode::CREATED, "{name}");
        key = answer.json()["id"].as_str().unwrap().to_owned();
    }
    for (name, body) in examples("rotate_key") {
        let answer = ask(server.post(&format!("/v1/keys/{key}/rotation")).json(&body)).await;
        assert_eq!(answer.status, StatusCode::CREATED, "{name}");
    }
}

async fn balls(server: &Server) -> Vec<String> {
    let mut balls = Vec::new();
    for ball in [SKIN_BALL, BONE_BALL] {
        let kept = server.upload(ball_stl(ball)).await.expect(StatusCode::CREATED);
        balls.push(kept["id"].as_str().unwrap().to_owned());
    }
    balls
}

/// The plans of the examples on a case; the id of the last.
async fn planned(server: &Server, case: &str) -> String {
    let mut plan = String::new();
    for (name, body) in examples("create_plan") {
        let request = server.post(&format!("/v1/cases/{case}/plans")).json(&body);
        let answer = ask(request).await;
        assert_eq!(answer.status, StatusCode::CREATED, "{name}");
        plan = answer.json()["id"].as_str().unwrap().to_owned();
    }
    for (name, body) in examples("replace_plan") {
        let path = format!("/v1/cases/{case}/plans/{}", plan);
        let request = server.request(reqwest::Method::PUT, &path).header("if-match", "*");
        assert_eq!(ask(request.json(&body)).await.status, StatusCode::OK, "{name}");
    }
    plan
}

async fn checked(server: &Server, case: &str) {
    for (name, body) in examples("check_case") {
        let request = server.post(&format!("/v1/cases/{case}/check")).json(&body);
        assert_eq!(ask(request).await.status, StatusCode::OK, "{name}");
    }
}

#[tokio::test]
async fn the_service_takes_every_example_as_it_stands_but_for_ids() {
    let server = Server::start();
    let mut meshes = Vec::new();
    for name in ["block.vtu", "mandible.stl"] {
        let kept = server.upload(file(name)).await.expect(StatusCode::CREATED);
        meshes.push(kept["id"].as_str().unwrap().to_owned());
    }
    let [volume, bone] = [(id(1), meshes[0].clone()), (id(2), meshes[1].clone())];
    let meshes = [(volume.0.as_str(), volume.1.as_str()), (bone.0.as_str(), bone.1.as_str())];
    let scan = server.upload(ball_ct()).await.expect(StatusCode::CREATED);
    let scan = scan["id"].as_str().unwrap().to_owned();
    let scan_id = id(6);
    let mut cases = Vec::new();
    for (_, body) in examples("create_case") {
        let body = with_ids(&body, &[&meshes[..], &[(scan_id.as_str(), scan.as_str())]].concat());
        let kept = ask(server.post("/v1/cases").json(&body)).await.expect(StatusCode::CREATED);
        cases.push(kept["id"].as_str().unwrap().to_owned());
    }
    let case = cases[0].clone();
    let plan = planned(&server, &case).await;
    checked(&server, &case).await;
    let [mut job, mut comparison] = [String::new(), String::new()];
    let balls = balls(&server).await;
    // The comparison is of a job that has ended, the cohort of one that has compared.
    let mut jobs = examples("create_job");
    jobs.sort_by_key(|(name, _)| (name != "predict", name != "compare"));
    for (name, body) in jobs {
        let [case_id, plan_id, job_id, skin_id, skull_id, comparison_id] =
            [3, 4, 5, 7, 8, 9].map(id);
        let ids = [
            (&case_id, &case),
            (&plan_id, &plan),
            (&job_id, &job),
            (&scan_id, &scan),
            (&skin_id, &balls[0]),
            (&skull_id, &balls[1]),
            (&comparison_id, &comparison),
        ];
        let ids: Vec<(&str, &str)> =
            ids.iter().map(|(from, to)| (from.as_str(), to.as_str())).chain(meshes).collect();
        let answer = server.job(&with_ids(&body, &ids)).await;
        assert!(answer.status.is_success(), "{name}: {}", answer.json());
        let ended = server.ended(answer.json()["id"].as_str().unwrap()).await;
        // A block is no face that could be brought to another one.
        let wanted = if name == "conform" { "failed" } else { "successful" };
        assert_eq!(ended["status"], wanted, "{name}: {ended}");
        if name == "compare" {
            comparison = ended["id"].as_str().unwrap().to_owned();
        }
        if job.is_empty() {
            job = ended["id"].as_str().unwrap().to_owned();
        }
    }
    for (name, body) in examples("change_job") {
        let request = server.request(reqwest::Method::PATCH, &format!("/v1/jobs/{job}"));
        assert_eq!(ask(request.json(&body)).await.status, StatusCode::OK, "{name}");
    }
    for (name, body) in examples("apply_response") {
        let request = server.post(&format!("/v1/cases/{case}/response/apply")).json(&body);
        assert_eq!(ask(request).await.status, StatusCode::OK, "{name}");
    }
    takes_keys(&server).await;
}
