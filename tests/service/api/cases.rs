//! Cases: kept with their meshes in one request, checked before anything is solved, erased with all of it.

use std::path::{Path, PathBuf};

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use reqwest::StatusCode;
use reqwest::multipart::Part;
use serde_json::json;

use crate::helpers::{SMALL, Server, ask, spec};
use crate::processes::until;

#[tokio::test]
async fn a_case_comes_with_its_meshes_or_refers_to_those_that_are_there() {
    let server = Server::start();
    let form = ask(server.post("/v1/cases").multipart(SMALL.form(&SMALL.case()))).await;
    let case = form.expect(StatusCode::CREATED);
    let id = case["id"].as_str().unwrap();
    assert_eq!(form.header("location"), format!("/v1/cases/{id}"));
    let mesh = &case["meshes"][0]["id"];
    assert_eq!(case["case"]["volume"], *mesh);
    let classes = &case["check"]["classes"];
    assert_eq!((&classes["joined"]["bone"], &classes["fixed"]), (&json!(25), &json!(25)));

    let mut document = SMALL.case();
    document["volume"] = mesh.clone();
    let second = ask(server.post("/v1/cases").json(&document)).await.expect(StatusCode::CREATED);
    assert_eq!(second["case"], case["case"]);
    let shown = ask(server.get(&format!("/v1/cases/{id}"))).await;
    assert_eq!(shown.expect(StatusCode::OK), case);
    let known = ask(server.get(&format!("/v1/cases/{id}")).header("if-none-match", "\"1\"")).await;
    assert_eq!(known.status, StatusCode::NOT_MODIFIED);
    for (query, count) in [("", 2), ("?tag=test", 2), ("?tag=other", 0), ("?limit=1", 1)] {
        let page = ask(server.get(&format!("/v1/cases{query}"))).await.expect(StatusCode::OK);
        assert_eq!(page["items"].as_array().unwrap().len(), count, "{query}");
    }
}

#[tokio::test]
async fn a_check_counts_what_holds_the_nodes_and_solves_nothing() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let path = format!("/v1/cases/{case}/check");
    let plan = json!({"plan": {"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]}});
    let report = ask(server.post(&path).json(&plan)).await.expect(StatusCode::OK);
    assert_eq!(report["classes"]["free"], 75);
    assert_eq!(report["unknowns"], 225);
    ask(server.post(&path).json(&json!({}))).await.expect(StatusCode::OK);
    let drawn = ask(server.post(&path).json(&plan).header("accept", "image/svg+xml")).await;
    assert_eq!(drawn.status, StatusCode::OK);
    assert_eq!(drawn.header("content-type"), "image/svg+xml");
    let neither = server.post(&path).json(&plan).header("accept", "image/png");
    ask(neither).await.problem(406, "not-acceptable");
    let unknown = json!({"plan": {"segments": [{"name": "nose", "translation_mm": [1, 0, 0]}]}});
    let problem = ask(server.post(&path).json(&unknown)).await.problem(422, "unknown-segment");
    assert_eq!(problem["errors"][0]["pointer"], "/plan/segments/0/name");
    let residual = json!({"tolerance": {"relative_residual": 0}});
    let problem = ask(server.post(&path).json(&residual)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/tolerance/relative_residual");
}

#[tokio::test]
async fn a_prediction_tells_that_cells_of_its_mesh_stand_twice() {
    let server = Server::start();
    let mut mesh = sample::block(Vector::new(60.0, 60.0, 30.0), [4, 4, 4], CellShape::Hex8);
    let inner = mesh.cells.nodes(21).to_vec();
    mesh.cells.push(CellShape::Hex8, &inner);
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Lps)).unwrap();
    let mut document = SMALL.case();
    document["volume"] = server.upload(bytes).await.expect(StatusCode::CREATED)["id"].clone();
    let case = ask(server.post("/v1/cases").json(&document)).await.expect(StatusCode::CREATED);
    let job = server.job(&spec(case["id"].as_str().unwrap(), 1.0)).await.json();
    let warnings = job["results"]["warnings"].as_array().unwrap().iter();
    let told = warnings.filter(|own| own["code"] == "duplicate-cells");
    assert_eq!(told.map(|own| own["first_cell"].as_f64()).collect::<Vec<_>>(), [Some(64.0)]);
}

#[tokio::test]
async fn the_picture_of_a_check_is_drawn_once_and_goes_with_its_case() {
    let server = Server::start_with(&["--workers", "0", "--mesh-cache-mib", "0"]);
    let case = server.case(&SMALL).await;
    let path = format!("/v1/cases/{case}");
    let check = format!("{path}/check");
    let picture = async |spec: &serde_json::Value| {
        ask(server.post(&check).json(spec).header("accept", "image/svg+xml")).await
    };
    let drawn = picture(&json!({})).await;
    assert_eq!(drawn.status, StatusCode::OK);
    for folder in std::fs::read_dir(server.path().join("blobs")).unwrap() {
        std::fs::remove_dir_all(folder.unwrap().path()).unwrap();
    }
    let again = picture(&json!({})).await;
    assert_eq!(again.status, StatusCode::OK, "what is known needs no mesh");
    assert!(again.bytes == drawn.bytes && again.bytes.starts_with(b"<svg"));
    let moved = json!({"plan": {"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]}});
    assert_ne!(picture(&moved).await.status, StatusCode::OK, "another question is asked anew");
    let erased = ask(server.delete(&path).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    picture(&json!({})).await.problem(410, "gone");
}

#[tokio::test]
async fn what_is_wrong_with_a_case_is_reported_and_nothing_of_it_is_kept() {
    let server = Server::start();
    let refused = async |change: &dyn Fn(&mut serde_json::Value)| {
        let mut case = SMALL.case();
        change(&mut case);
        ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await
    };
    let answer = refused(&|case| case["fixed"] = json!([{"node_set": "nowhere"}])).await;
    let problem = answer.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/fixed/0");
    let answer = refused(&|case| case["bones"] = json!([{"name": "jaw", "mesh": "jaw"}])).await;
    let problem = answer.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/bones/0/mesh");
    let answer = refused(&|case| case["volume"] = json!("other")).await;
    answer.problem(422, "unused-part");
    let answer = refused(&|case| case["frame"] = json!("up")).await;
    answer.problem(422, "validation-failed");

    let form = SMALL.form(&SMALL.case()).part("bad", Part::text("not a mesh"));
    let answer = ask(server.post("/v1/cases").multipart(form)).await;
    assert_eq!(answer.problem(415, "unsupported-media-type")["part"], "bad");
    let no_case = reqwest::multipart::Form::new().part("block", Part::bytes(SMALL.vtu()));
    let answer = ask(server.post("/v1/cases").multipart(no_case)).await;
    answer.problem(400, "malformed-multipart");

    let listed = ask(server.get("/v1/cases")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"], json!([]));
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap().count();
    assert_eq!(blobs, 0, "no mesh of a refused case is kept");
}

#[tokio::test]
async fn a_case_that_only_a_plan_holds_is_kept() {
    let server = Server::start();
    let mut document = SMALL.case();
    document["segments"] = json!([]);
    document["fixed"] = json!([]);
    let answer = ask(server.post("/v1/cases").multipart(SMALL.form(&document))).await;
    let case = answer.expect(StatusCode::CREATED);
    assert!(case.get("check").is_none());
    let mut loose = spec(case["id"].as_str().unwrap(), 1.0);
    loose["plan"] = json!({"segments": []});
    let answer = ask(server.post("/v1/jobs").json(&loose)).await;
    answer.problem(422, "underconstrained");
    let moved = json!({"name": "z_min", "translation_mm": [1, 0, 0]});
    let still = json!({"name": "z_max", "translation_mm": [0, 0, 0]});
    loose["plan"] = json!({"segments": [moved, still]});
    server.job(&loose).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn erasing_a_case_takes_its_jobs_results_and_meshes_along() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let shared = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let path = format!("/v1/cases/{case}");
    let meshes = ask(server.get(&path)).await.json()["meshes"].clone();
    let own = format!("/v1/meshes/{}", meshes[0]["id"].as_str().unwrap());
    ask(server.delete(&own)).await.problem(409, "conflict-in-use");
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let job = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    ask(server.delete(&path)).await.problem(428, "precondition-required");
    ask(server.delete(&path).header("if-match", "\"9\"")).await.problem(412, "precondition-failed");
    let erased = ask(server.delete(&path).header("if-match", "\"1\"")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    ask(server.get(&path)).await.problem(410, "gone");
    ask(server.get(&job)).await.problem(410, "gone");
    ask(server.get(&own)).await.problem(410, "gone");
    let kept = format!("/v1/meshes/{}", shared["id"].as_str().unwrap());
    ask(server.get(&kept)).await.expect(StatusCode::OK);
    let files = |name: &str| {
        let folders = std::fs::read_dir(server.path().join(name)).unwrap();
        let count = |folder: std::path::PathBuf| std::fs::read_dir(folder).unwrap().count();
        folders.map(|folder| count(folder.unwrap().path())).sum::<usize>()
    };
    assert_eq!(files("blobs"), 1, "the mesh that was uploaded by itself stays");
}

/// Of 60 uploads beside erasures of the same bytes 41 were refused once, three of them for a mesh that they had brought along.
#[tokio::test]
async fn cases_with_the_same_bytes_are_stored_while_another_is_erased() {
    let server = Server::start_with(&["--workers", "0"]);
    let mut before = server.case(&SMALL).await;
    for _ in 0..6 {
        let path = format!("/v1/cases/{before}");
        let post = || ask(server.post("/v1/cases").multipart(SMALL.form(&SMALL.case())));
        let erase = ask(server.delete(&path).header("if-match", "*"));
        let (erased, one, two, three, four) = tokio::join!(erase, post(), post(), post(), post());
        assert_eq!(erased.status, StatusCode::NO_CONTENT);
        let mut ids = Vec::new();
        for stored in [one, two, three, four] {
            ids.push(stored.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned());
        }
        for id in &ids[1..] {
            let path = format!("/v1/cases/{id}");
            let erased = ask(server.delete(&path).header("if-match", "*")).await;
            assert_eq!(erased.status, StatusCode::NO_CONTENT);
        }
        before = ids.swap_remove(0);
    }
}

#[tokio::test]
async fn erasing_a_case_leaves_the_predictions_of_an_equal_one() {
    let server = Server::start();
    let (first, second) = (server.case(&SMALL).await, server.case(&SMALL).await);
    let mut jobs = Vec::new();
    for case in [&first, &second] {
        let job = server.job(&spec(case, 1.0)).await.expect(StatusCode::OK);
        assert_eq!(job["case"], json!(case));
        jobs.push((job["id"].as_str().unwrap().to_owned(), job["spec_hash"].clone()));
    }
    assert_ne!(jobs[0].0, jobs[1].0, "each case has a job of its own");
    assert_eq!(jobs[0].1, jobs[1].1, "of the same inputs");
    let again = server.job(&spec(&first, 1.0)).await.expect(StatusCode::OK);
    assert_eq!(again["id"], json!(jobs[0].0));
    let path = format!("/v1/cases/{first}");
    let erased = ask(server.delete(&path).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    ask(server.get(&format!("/v1/jobs/{}", jobs[0].0))).await.problem(410, "gone");
    ask(server.get(&format!("/v1/jobs/{}", jobs[1].0))).await.expect(StatusCode::OK);
}

/// The files below a folder that hold a text.
fn holding(folder: &Path, text: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let holds = |path: PathBuf| match std::fs::read(&path) {
        Ok(bytes) if bytes.windows(text.len()).any(|part| part == text.as_bytes()) => vec![path],
        Ok(_) => Vec::new(),
        Err(_) if path.is_dir() => holding(&path, text),
        // It went meanwhile.
        Err(_) => Vec::new(),
    };
    entries.flat_map(holds).collect()
}

#[tokio::test]
async fn names_of_erased_cases_are_in_no_file_soon_after_and_none_when_the_service_has_ended() {
    const NAME: &str = "Wilhelmine Mustermann";
    let server = Server::start();
    let named = async || {
        let mut case = SMALL.case();
        case["name"] = NAME.into();
        let case = ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await;
        let case = case.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
        assert!(!holding(server.path(), NAME).is_empty());
        let path = format!("/v1/cases/{case}");
        let erase = server.delete(&path).header("if-match", "*");
        assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    };
    named().await;
    until("the name is in no file", async || holding(server.path(), NAME).is_empty().then_some(()))
        .await;
    named().await;
    let (folder, ended) = server.terminate();
    assert!(ended);
    assert_eq!(holding(folder.path(), NAME), [] as [PathBuf; 0]);
}
