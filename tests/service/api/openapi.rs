//! The description of the service.

use reqwest::StatusCode;
use serde_json::Value;

use crate::helpers::{Server, ask};

#[test]
fn the_openapi_file_equals_the_code() {
    let made: Value = serde_json::to_value(facies::api::document()).unwrap();
    let file: Value = serde_json::from_str(include_str!("../../../openapi/openapi.json")).unwrap();
    assert!(made == file, "make it anew: cargo run -- openapi > openapi/openapi.json");
}

#[test]
fn every_error_that_is_described_is_a_problem() {
    let document = serde_json::to_value(facies::api::document()).unwrap();
    let mut seen = 0;
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            for (status, response) in operation["responses"].as_object().unwrap() {
                let place = format!("{method} {path} {status}");
                assert!(!response["description"].as_str().unwrap().is_empty(), "{place}");
                if status.starts_with(['4', '5']) {
                    let content = response["content"].as_object().unwrap();
                    assert_eq!(
                        content.keys().collect::<Vec<_>>(),
                        ["application/problem+json"],
                        "{place}"
                    );
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 100, "{seen}");
}

/// Generators of clients name functions and types after them.
#[test]
fn every_operation_has_a_name_of_its_own_and_every_reference_leads_somewhere() {
    let document = facies::api::document();
    let mut names = std::collections::BTreeSet::new();
    for item in document["paths"].as_object().unwrap().values() {
        for operation in item.as_object().unwrap().values() {
            let name = operation["operationId"].as_str().unwrap();
            assert!(names.insert(name.to_owned()), "two operations are called {name}");
        }
    }
    assert!(names.len() > 20, "{names:?}");
    let text = document.to_string();
    for reference in text.split("\"#/components/schemas/").skip(1) {
        let name = reference.split('"').next().unwrap();
        assert!(document["components"]["schemas"].get(name).is_some(), "there is no {name}");
    }
    for part in ["\"allOf\"", "BTreeMap", "\"uuid\""] {
        assert!(!text.contains(part), "{part}");
    }
}

#[tokio::test]
async fn the_description_and_its_pages_are_served_without_a_network() {
    let server = Server::start();
    let served = ask(server.get("/openapi.json")).await.expect(StatusCode::OK);
    assert_eq!(served, serde_json::to_value(facies::api::document()).unwrap());
    let page = ask(server.get("/docs/")).await;
    assert_eq!(page.status, StatusCode::OK);
    let page = String::from_utf8(page.bytes).unwrap();
    assert!(page.contains("swagger-ui"));
    assert!(!page.contains("https://"), "the page loads nothing from elsewhere");
    let script = ask(server.get("/docs/swagger-ui-bundle.js")).await;
    assert_eq!(script.status, StatusCode::OK);
}

#[tokio::test]
async fn limits_and_methods_are_reported() {
    let server = Server::start();
    let limits = ask(server.get("/v1/limits")).await.expect(StatusCode::OK);
    assert_eq!((&limits["upload_bytes"], &limits["wait_s"]), (&(256 << 20).into(), &30.into()));
    let muscles = (&limits["muscle_work"], &limits["muscle_samples"]);
    assert_eq!(muscles, (&1_000_000_000.into(), &512.into()));
    assert_eq!(limits["hounsfield_points"], 1_000_000_000);
    assert_eq!(limits["check_s"], 30.0);
    let methods = ask(server.get("/v1/methods")).await.expect(StatusCode::OK);
    assert_eq!(methods["methods"][0]["name"], "fem_linear");
    let response = &methods["response"];
    assert_eq!(
        (&response["columns_per_segment"], &response["linear_range_mm"]),
        (&12.into(), &0.5.into())
    );
    assert_eq!(methods["optimise"]["undetermined_below"], 1e-5);
}

#[tokio::test]
async fn materials_of_the_literature_are_reported_with_their_sources() {
    let server = Server::start();
    let list = ask(server.get("/v1/materials")).await.expect(StatusCode::OK);
    let presets = list["presets"].as_array().unwrap();
    let fat = presets.iter().find(|preset| preset["name"] == "fat_kim_2012").unwrap();
    assert_eq!(fat["material"]["young_modulus_kpa"], 3.0);
    assert_eq!(
        (&fat["source"]["year"], &fat["source"]["place"]),
        (&2012.into(), &"table 2".into())
    );
    let muscle = presets.iter().find(|preset| preset["name"] == "muscle_kim_2012").unwrap();
    assert!(muscle["doubt"].as_str().unwrap().contains("softer along"));
    assert_eq!(
        (list["measured"].as_array().unwrap().len(), &muscle["needs_course"]),
        (12, &true.into())
    );
}
