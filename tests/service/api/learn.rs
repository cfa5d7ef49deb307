//! Learning over HTTP: a model of operated cases corrects another one, and goes with each case that it was learned from.

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask, spec};

/// The block after an operation, as it was measured.
fn after(number: usize) -> Vec<u8> {
    after_beside(number, Vector::zeros(), Frame::Unspecified)
}

/// The same as it lies in a scanner, by so much beside the case and in a frame.
pub fn after_beside(number: usize, beside: Vector, frame: Frame) -> Vec<u8> {
    let mut mesh = sample::block(Vector::new(60.0, 60.0, 30.0), SMALL.cells, CellShape::Hex8);
    let moved = |z: f64| Vector::new(number as f64 * (1.0 - z / 30.0), 0.0, 0.3) + beside;
    mesh.nodes.iter_mut().for_each(|node| *node += moved(node.z));
    vtu::write(&VolumeOutput::plain(&mesh, frame)).unwrap()
}

pub fn linear(case: &str, x: f64) -> Value {
    let mut spec = spec(case, x);
    spec["method"] = json!("fem_linear");
    spec
}

#[tokio::test]
async fn a_model_goes_with_each_case_that_it_was_learned_from_and_so_does_what_it_corrected() {
    let server = Server::start();
    let (mut cases, mut members, mut jobs) = (Vec::new(), Vec::new(), Vec::new());
    for number in 1..=3 {
        let case = server.case(&SMALL).await;
        let job = server.job(&linear(&case, number as f64)).await.expect(StatusCode::OK);
        let actual = server.upload(after(number)).await.expect(StatusCode::CREATED);
        members.push(json!({"prediction": job["id"], "actual": actual["id"]}));
        cases.push(case);
        jobs.push(job["id"].as_str().unwrap().to_owned());
    }
    let learned = server.job(&json!({"kind": "learn", "cases": members})).await;
    let learned = learned.expect(StatusCode::OK);
    assert_eq!(learned["status"], "successful", "{learned}");
    let table = learned["results"]["learning"]["table"].as_array().unwrap();
    assert!(table.len() == 12 && learned["results"]["learning"]["helps"].is_boolean(), "{learned}");

    // A fourth case is corrected; one of the three is not.
    let fourth = server.case(&SMALL).await;
    let corrected = |case: &str| {
        let mut spec = linear(case, 2.2);
        spec["correction"] = json!({"model": learned["id"]});
        spec
    };
    let done = server.job(&corrected(&fourth)).await.expect(StatusCode::OK);
    assert_eq!(done["status"], "successful", "{done}");
    assert!(done["results"]["correction"]["changed_mm"].as_f64().unwrap() > 0.0, "{done}");
    let own = server.job(&corrected(&cases[0])).await.problem(422, "validation-failed");
    let told = &own["errors"][0];
    assert_eq!(
        (&told["pointer"], &told["code"]),
        (&json!("/correction/model"), &json!("duplicate-name"))
    );

    // Two predictions of one case are one patient.
    let again = server.job(&linear(&cases[0], 2.5)).await.expect(StatusCode::OK);
    let mut twice = members.clone();
    twice[2]["prediction"] = again["id"].clone();
    let problem = server.job(&json!({"kind": "learn", "cases": twice})).await;
    let problem = problem.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/cases/2/prediction");

    // What goes with a case is known before: the model, and what that corrected of another.
    let of = async |case: &str, kind: &str| -> Vec<Value> {
        let listed = ask(server.get(&format!("/v1/jobs?kind={kind}&case={case}"))).await;
        let jobs = listed.expect(StatusCode::OK)["items"].as_array().unwrap().clone();
        jobs.iter().map(|job| job["id"].clone()).collect()
    };
    assert_eq!(of(&cases[1], "learn").await, [learned["id"].clone()]);
    assert_eq!(of(&cases[1], "predict").await, [done["id"].clone(), json!(jobs[1])]);
    assert_eq!(of(&fourth, "learn").await, Vec::<Value>::new());

    // Erasing a case erases what was learned from it, and nothing of the others.
    let path = format!("/v1/cases/{}", cases[1]);
    let erased = ask(server.delete(&path).header("if-match", "\"1\"")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    for gone in [&learned["id"], &done["id"]] {
        let path = format!("/v1/jobs/{}", gone.as_str().unwrap());
        ask(server.get(&path)).await.problem(410, "gone");
    }
    ask(server.get(&format!("/v1/jobs/{}", jobs[0]))).await.expect(StatusCode::OK);
    ask(server.get(&format!("/v1/cases/{fourth}"))).await.expect(StatusCode::OK);
}
