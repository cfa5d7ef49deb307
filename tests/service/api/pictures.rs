//! Pictures of predictions: drawn when they are first asked for, and gone with what they show.

use std::fs;

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

const PICTURES: [&str; 2] = ["classes.svg", "displacement.svg"];
const REPORTS: [&str; 2] = ["report.html", "report.pdf"];

fn place(job: &Value, name: &str) -> String {
    format!("/v1/jobs/{}/results/{name}", job["id"].as_str().unwrap())
}

async fn picture(server: &Server, job: &Value, name: &str) -> Answer {
    ask(server.get(&place(job, name)).header("accept", "image/svg+xml")).await
}

#[tokio::test]
async fn a_picture_that_is_asked_for_later_is_the_one_that_the_job_would_have_drawn() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let plain = server.job(&spec(&case, 2.0)).await.expect(StatusCode::OK);
    let mut with_pictures = spec(&case, 2.0);
    with_pictures["outputs"] = json!(["skin.vtp", "classes.svg", "displacement.svg"]);
    let drawn = server.job(&with_pictures).await.expect(StatusCode::OK);
    assert_ne!(plain["id"], drawn["id"]);
    assert_eq!(plain["results"]["pictures"], json!([PICTURES, REPORTS].concat()));
    assert_eq!(drawn["results"]["pictures"], json!(REPORTS), "the others are files");
    let mut later = Vec::new();
    for name in PICTURES {
        let file = |job: &Value| {
            let files = job["results"]["files"].as_array().unwrap().iter();
            files.filter(|file| file["name"] == name).count()
        };
        assert_eq!((file(&plain), file(&drawn)), (0, 1), "{name}");
        let first = picture(&server, &plain, name).await;
        assert_eq!(first.header("content-type"), "image/svg+xml");
        assert!(first.bytes == picture(&server, &drawn, name).await.bytes, "{name}");
        let tag = first.header("etag").to_owned();
        let again = ask(server.get(&place(&plain, name)).header("if-none-match", &tag)).await;
        assert_eq!((again.status, again.bytes.len()), (StatusCode::NOT_MODIFIED, 0));
        later.push(first.bytes);
    }
    let refused = ask(server.get(&place(&plain, PICTURES[0])).header("accept", "image/png")).await;
    refused.problem(406, "not-acceptable");

    let (folder, ended) = server.terminate();
    assert!(ended);
    let server = Server::start_in(folder, &["--workers", "0"]);
    for (name, before) in PICTURES.iter().zip(later) {
        assert!(picture(&server, &plain, name).await.bytes == before, "{name} after a restart");
    }
    let path = format!("/v1/jobs/{}", plain["id"].as_str().unwrap());
    ask(server.delete(&path)).await.expect(StatusCode::NO_CONTENT);
    picture(&server, &plain, PICTURES[0]).await.problem(410, "gone");
    let path = format!("/v1/cases/{case}");
    ask(server.delete(&path).header("if-match", "*")).await.expect(StatusCode::NO_CONTENT);
    picture(&server, &drawn, PICTURES[0]).await.problem(410, "gone");
}

#[tokio::test]
async fn a_picture_without_its_source_is_refused_and_not_promised() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut spec = spec(&case, 1.0);
    spec["outputs"] = json!(["skin.stl"]);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    assert_eq!(job["results"]["pictures"], json!(["classes.svg"]));
    assert_eq!(picture(&server, &job, "classes.svg").await.status, StatusCode::OK);
    let refused = picture(&server, &job, "displacement.svg").await;
    let problem = refused.problem(404, "no-such-output");
    assert!(problem["detail"].as_str().unwrap().contains("skin.vtp"), "{problem}");
    picture(&server, &job, "nothing.svg").await.problem(404, "no-such-output");
    let response = json!({"kind": "response", "case": case});
    let response = server.job(&response).await.expect(StatusCode::OK);
    picture(&server, &response, "classes.svg").await.problem(404, "no-such-output");
}

#[tokio::test]
async fn a_plan_that_was_found_has_the_picture_of_its_skin() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let wanted = json!({
        "kind": "optimise", "case": case,
        "targets": [{"landmark": "middle", "displacement_mm": [1, null, null]}],
        "bounds": {"bone": {"translation_mm": [[-5, 5], [0, 0], [0, 0]]}},
    });
    let job = server.job(&wanted).await.expect(StatusCode::OK);
    let svg = picture(&server, &job, "displacement.svg").await;
    let text = String::from_utf8(svg.bytes).unwrap();
    assert!(text.contains("moved: bone"), "{}", &text[..400.min(text.len())]);
}

#[tokio::test]
async fn a_picture_whose_mesh_cannot_be_read_is_one_refusal_and_the_result_stays() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    for name in PICTURES {
        assert_eq!(picture(&server, &job, name).await.status, StatusCode::OK);
    }
    let skin = job["results"]["files"].as_array().unwrap().iter();
    let skin = skin.into_iter().find(|file| file["name"] == "skin.vtp").unwrap();
    let blobs = server.path().join("blobs");
    let place = find(&blobs, skin["sha256"].as_str().unwrap()).expect("the stored skin");
    fs::write(&place, b"damaged").unwrap();
    // What was drawn is kept, and not drawn again.
    let kept = picture(&server, &job, "displacement.svg").await;
    assert_eq!(kept.status, StatusCode::OK);
    let (folder, _) = server.terminate();
    let server = Server::start_in(folder, &["--workers", "0"]);
    picture(&server, &job, "displacement.svg").await.problem(500, "integrity");
    assert_eq!(picture(&server, &job, "classes.svg").await.status, StatusCode::OK);
    let path = format!("/v1/jobs/{}/results", job["id"].as_str().unwrap());
    assert_eq!(ask(server.get(&path)).await.status, StatusCode::OK);
}

/// The stored file of a hash.
fn find(folder: &std::path::Path, sha256: &str) -> Option<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.into_iter().find_map(|path| {
        let is_it =
            || facies::schema::wire::canonical::sha256_hex(&fs::read(&path).unwrap()) == sha256;
        match path.is_dir() {
            true => find(&path, sha256),
            false => is_it().then_some(path.clone()),
        }
    })
}
