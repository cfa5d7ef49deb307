//! Where people and programs begin, and what browsers are told of every answer.

use reqwest::StatusCode;
use serde_json::json;

use super::tenants::Hospital;
use crate::helpers::{SMALL, Server, ask};

#[tokio::test]
async fn the_root_leads_on() {
    let server = Server::start();
    for path in ["/", "/v1"] {
        let answer = ask(server.get(path)).await.expect(StatusCode::OK);
        for (name, link) in answer["links"].as_object().unwrap() {
            let link = link.as_str().unwrap();
            let found = ask(server.get(link)).await.status;
            let is_list = found == StatusCode::METHOD_NOT_ALLOWED && name == "meshes";
            assert!(found == StatusCode::OK || is_list, "{link} answers {found}");
        }
    }
    let browser = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";
    let page = ask(server.get("/").header("accept", browser)).await;
    assert_eq!(page.status, StatusCode::OK);
    assert!(page.header("content-type").starts_with("text/html"));
    let page = String::from_utf8(page.bytes).unwrap();
    let links: Vec<&str> =
        page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(links.contains(&"/docs/") && links.contains(&"/v1"), "{links:?}");
    for link in links {
        assert_eq!(ask(server.get(link)).await.status, StatusCode::OK, "{link}");
    }
}

#[tokio::test]
async fn the_page_runs_files_of_the_program_alone() {
    let server = Server::start();
    let page = ask(server.get("/").header("accept", "text/html")).await;
    let text = String::from_utf8(page.bytes.clone()).unwrap();
    let named = |name: &str| -> Vec<String> {
        let begin = format!("{name}=\"/assets/");
        let after = text.split(&begin).skip(1);
        after.map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
    };
    let [scripts, others] = [named("src"), named("href")];
    assert!(scripts.contains(&"page.js".to_owned()) && others.len() >= 2, "{text}");
    for (name, kind) in [("page.js", "text/javascript"), ("three.js", "text/javascript")]
        .into_iter()
        .chain([("index.css", "text/css"), ("icon.svg", "image/svg+xml")])
    {
        let path = format!("/assets/{name}");
        let file = ask(server.get(&path)).await;
        assert_eq!(file.status, StatusCode::OK, "{name}");
        assert!(file.header("content-type").starts_with(kind), "{name}");
        let known = server.get(&path).header("if-none-match", file.header("etag"));
        assert_eq!(ask(known).await.status, StatusCode::NOT_MODIFIED, "{name}");
        assert_eq!(file.header("content-security-policy"), page.header("content-security-policy"));
    }
    let policy = page.header("content-security-policy");
    assert!(policy.contains("script-src 'self';") && policy.contains("style-src 'self';"));
    assert!(!policy.contains("unsafe") && !policy.contains("http"), "{policy}");
    assert!(!text.contains("<style") && !text.contains("style=") && !text.contains("<script>"));
    ask(server.get("/assets/none.js")).await.problem(404, "not-found");
}

#[tokio::test]
async fn no_answer_lets_a_browser_run_anything_but_the_documentation() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["read", "write", "run"]).await;
    let server = &hospital.server;
    let form = server.post("/v1/cases").bearer_auth(&key).multipart(SMALL.form(&SMALL.case()));
    let case = ask(form).await.expect(StatusCode::CREATED);
    let check = format!("/v1/cases/{}/check", case["id"].as_str().unwrap());
    let picture = server.post(&check).bearer_auth(&key).header("accept", "image/svg+xml");
    let picture = ask(picture.json(&json!({}))).await;
    assert_eq!(picture.header("content-type"), "image/svg+xml");
    assert_eq!(picture.header("content-disposition"), "attachment; filename=\"check.svg\"");
    let mut answers = vec![("the picture", picture)];
    for path in ["/", "/v1", "/openapi.json", "/healthz", "/v1/cases", "/v1/nothing", "/nothing"] {
        answers.push((path, hospital.get(&key, path).await));
    }
    for path in ["/metrics", "/healthz", "/tenants"] {
        answers.push((path, ask(hospital.admin(reqwest::Method::GET, path)).await));
    }
    for (path, answer) in answers {
        let policy = answer.header("content-security-policy");
        assert!(policy.starts_with("default-src 'none';"), "{path}: {policy:?}");
        assert!(!policy.contains("script-src"), "{path}: {policy:?}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff", "{path}");
    }
    let pages = ask(server.get("/docs/")).await;
    let policy = pages.header("content-security-policy").to_owned();
    assert!(policy.contains("script-src 'self';") && !policy.contains("http"), "{policy}");
    let page = String::from_utf8(pages.bytes).unwrap();
    assert!(!page.contains("<script>") && !page.contains("onload="), "it runs with this policy");
    let settings = ask(server.get("/docs/swagger-initializer.js")).await;
    let settings = String::from_utf8(settings.bytes).unwrap();
    assert!(settings.contains(r#""validatorUrl": "none""#), "{settings}");
}
