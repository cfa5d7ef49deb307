//! Meshes that a prediction keeps: meshes like any other, which go with the case that they came from.

use std::process::Command;

use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::mesh::Vector;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

/// A prediction that keeps some of its meshes; its result.
async fn kept(server: &Server, case: &str, outputs: &[&str]) -> Value {
    let mut spec = spec(case, 1.5);
    spec["keep"] = json!(["volume", "skin", "volume"]);
    spec["outputs"] = json!(outputs);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    job
}

fn mesh_of(job: &Value, place: usize) -> String {
    job["results"]["kept"][place]["mesh"].as_str().unwrap().to_owned()
}

async fn mesh(server: &Server, id: &str) -> Answer {
    ask(server.get(&format!("/v1/meshes/{id}"))).await
}

async fn content(server: &Server, path: &str) -> Mesh {
    let bytes = ask(server.get(path)).await.bytes;
    read(&bytes, &ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() })
        .unwrap()
        .mesh
}

async fn erase(server: &Server, path: &str) {
    let erased = ask(server.delete(path).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT, "{path}");
}

fn points(mesh: Mesh) -> Vec<Vector> {
    match mesh {
        Mesh::Volume(volume) => volume.nodes,
        Mesh::Surface(surface) => surface.points,
        Mesh::Image(_) => panic!("an image"),
    }
}

#[tokio::test]
async fn a_kept_mesh_is_where_the_prediction_has_it_and_like_one_that_was_uploaded() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = kept(&server, &case, &["skin.vtp", "volume.vtu"]).await;
    let id = job["id"].as_str().unwrap();
    for (place, (what, file)) in [("skin", "skin.vtp"), ("volume", "volume.vtu")].iter().enumerate()
    {
        let told = &job["results"]["kept"][place];
        let mesh_id = mesh_of(&job, place);
        let href = format!("/v1/meshes/{mesh_id}");
        assert_eq!((&told["what"], &told["link"]["href"]), (&json!(what), &json!(href)));
        assert!(job["links"].as_array().unwrap().contains(&told["link"]), "{job}");
        let shown = mesh(&server, &mesh_id).await.expect(StatusCode::OK);
        assert_eq!((&shown["role"], &shown["units"]), (&json!(what), &json!("mm")));
        // As in the file of the result, and as many bytes lead to it as to any mesh.
        let of_file = content(&server, &format!("/v1/jobs/{id}/results/{file}")).await;
        let of_mesh = content(&server, &format!("{href}/content")).await;
        assert_eq!(points(of_mesh), points(of_file), "{what}");
        let bytes = ask(server.get(&format!("{href}/content"))).await.bytes;
        let upload = server.post("/v1/meshes?units=mm&allow_any_scale=true").body(bytes);
        let upload = upload.header("content-type", "application/octet-stream");
        assert_eq!(ask(upload).await.expect(StatusCode::OK)["id"], mesh_id.as_str());
    }
    assert_eq!(job["results"]["kept"].as_array().unwrap().len(), 2, "each is kept once");
    let manifest = ask(server.get(&format!("/v1/jobs/{id}/results/result.json"))).await.json();
    assert_eq!(manifest["kept"], job["results"]["kept"]);
    let plain = server.job(&spec(&case, 1.5)).await.expect(StatusCode::OK);
    assert!(plain["results"].get("kept").is_none(), "nothing is kept where nobody asks for it");
}

#[tokio::test]
async fn a_kept_mesh_goes_with_its_case_unless_another_case_uses_it() {
    let server = Server::start();
    let first = server.case(&SMALL).await;
    let job = kept(&server, &first, &["skin.stl"]).await;
    let (skin, volume) = (mesh_of(&job, 0), mesh_of(&job, 1));
    let mut moved = SMALL.case();
    moved["volume"] = json!(volume);
    let second = ask(server.post("/v1/cases").json(&moved)).await.expect(StatusCode::CREATED);
    let second = second["id"].as_str().unwrap();
    let solved = server.job(&spec(second, 0.5)).await.expect(StatusCode::OK);
    assert_eq!(solved["status"], "successful", "{solved}");

    erase(&server, &format!("/v1/cases/{first}")).await;
    mesh(&server, &skin).await.problem(410, "gone");
    mesh(&server, &volume).await.expect(StatusCode::OK);
    erase(&server, &format!("/v1/cases/{second}")).await;
    mesh(&server, &volume).await.problem(410, "gone");

    let (folder, _) = server.terminate();
    let mut fsck = Command::new(env!("CARGO_BIN_EXE_facies"));
    let found = fsck.args(["admin", "fsck", "--read-all", "--data"]).arg(folder.path()).output();
    assert!(found.unwrap().status.success(), "nothing is left over");
    let folders = std::fs::read_dir(folder.path().join("blobs")).unwrap();
    let left = folders.flat_map(|entry| std::fs::read_dir(entry.unwrap().path()).unwrap()).count();
    assert_eq!(left, 0, "no bytes are left");
}

#[tokio::test]
async fn a_kept_mesh_stays_as_long_as_one_of_the_jobs_that_made_it() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let jobs =
        [kept(&server, &case, &["skin.stl"]).await, kept(&server, &case, &["skin.ply"]).await];
    let ids = jobs.each_ref().map(|job| job["id"].as_str().unwrap());
    assert_ne!(ids[0], ids[1]);
    let skin = mesh_of(&jobs[0], 0);
    assert_eq!(mesh_of(&jobs[1], 0), skin, "the same content is one mesh");
    let in_use = ask(server.delete(&format!("/v1/meshes/{skin}"))).await;
    let told = in_use.problem(409, "conflict-in-use");
    let users = ids.map(|id| json!({"kind": "job", "id": id}));
    assert_eq!((&told["count"], &told["users"]), (&json!(2), &json!(users)), "{told}");
    let detail = told["detail"].as_str().unwrap();
    assert!(ids.iter().all(|id| detail.contains(id)) && !detail.contains("more"), "{detail}");
    erase(&server, &format!("/v1/jobs/{}", ids[0])).await;
    mesh(&server, &skin).await.expect(StatusCode::OK);
    erase(&server, &format!("/v1/jobs/{}", ids[1])).await;
    mesh(&server, &skin).await.problem(410, "gone");
    // Solved once more, it is another mesh: an id that is gone stays so.
    let again = kept(&server, &case, &["skin.stl"]).await;
    assert_ne!(mesh_of(&again, 0), skin);
}

#[tokio::test]
async fn a_variant_of_a_study_keeps_nothing() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut item = json!({"case": case, "plan": spec(&case, 1.0)["plan"], "keep": ["skin"]});
    let batch = |item: &Value| json!({"kind": "batch", "items": [item]});
    let refused = ask(server.post("/v1/jobs").json(&batch(&item))).await;
    let refused = refused.problem(422, "validation-failed");
    let told = &refused["errors"][0];
    assert_eq!(
        (&told["code"], &told["pointer"]),
        (&json!("unknown-field"), &json!("/items/0/keep"))
    );
    item.as_object_mut().unwrap().remove("keep");
    ask(server.post("/v1/jobs").json(&batch(&item))).await.expect(StatusCode::CREATED);
    let unknown = json!({"kind": "predict", "case": case, "plan": {}, "keep": ["bones"]});
    ask(server.post("/v1/jobs").json(&unknown)).await.problem(422, "validation-failed");
}
