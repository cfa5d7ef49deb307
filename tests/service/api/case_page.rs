//! The page on the case document: the service takes every block of it.

use std::collections::{BTreeMap, BTreeSet};

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput, nrrd};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector, sample};
use mechanics::muscle::strap::box_surface;
use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};

use crate::helpers::{Answer, Server, ask};

const PAGE: &str = include_str!("../../../docs/case.md");

/// Each block with the heading over it.
fn blocks() -> Vec<(&'static str, Value)> {
    let sections = PAGE.split("\n## ").skip(1);
    let blocks = sections.flat_map(|section| {
        let heading = section.lines().next().unwrap();
        let texts = section.split("```json\n").skip(1);
        texts.map(move |text| (heading, text.split("```").next().unwrap()))
    });
    let read = |text| serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"));
    blocks.map(|(heading, text)| (heading, read(text))).collect()
}

/// A block of 80 x 60 x 20 mm with skull and mandible under it, and every array that the page speaks of.
fn face() -> Vec<u8> {
    let mut mesh = sample::block(Vector::new(80.0, 60.0, 20.0), [8, 6, 4], CellShape::Tet4);
    let nodes = mesh.nodes.clone();
    let chosen = |is_in: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        (0..).zip(&nodes).filter(|(_, node)| is_in(node)).map(|(number, _)| number).collect()
    };
    mesh.node_sets = BTreeMap::from([
        ("skull".to_owned(), chosen(&|node| node.z == 0.0 && node.x < 21.0)),
        ("mandible".to_owned(), chosen(&|node| node.z == 0.0 && node.x > 39.0)),
        ("skin".to_owned(), chosen(&|node| node.z == 20.0)),
        ("chin".to_owned(), chosen(&|node| node.z == 20.0 && node.x > 59.0)),
        ("side".to_owned(), chosen(&|node| node.y == 0.0 && node.z > 1.0 && node.z < 19.0)),
    ]);
    let tag = |node: &Vector| match (node.z, node.x) {
        (0.0, x) if x < 21.0 => 1,
        (0.0, x) if x > 39.0 => 2,
        (0.0, _) => 3,
        _ => 0,
    };
    mesh.node_labels.insert("tag".to_owned(), nodes.iter().map(tag).collect());
    let cells = mesh.cells.len();
    let layers = (0..cells).map(|cell| i64::from(2 * cell >= cells));
    mesh.cell_labels.insert("layer".to_owned(), layers.collect());
    mesh.cell_vectors.insert("fibre".to_owned(), vec![Vector::x(); cells]);
    mesh.node_vectors.insert("lines".to_owned(), vec![Vector::repeat(1.0); nodes.len()]);
    mesh.node_vectors.insert("u_mm".to_owned(), vec![Vector::x(); nodes.len()]);
    vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap()
}

/// The plate under the block from x = 40 mm.
fn mandible() -> Vec<u8> {
    let corner = |x: f64, y: f64| Vector::new(x, y, 0.0);
    let surface = TriangleSurface {
        points: vec![corner(40.0, 0.0), corner(80.0, 0.0), corner(80.0, 60.0), corner(40.0, 60.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        node_ids: None,
    };
    vtp::write(&SurfaceOutput::plain(&surface, Frame::Unspecified)).unwrap()
}

/// A strap in the middle.
fn muscle() -> Vec<u8> {
    let half = [(0, 20.0), (1, 6.0), (2, 6.0)].map(|(axis, size)| Vector::ith(axis, size));
    let surface = box_surface(Vector::new(40.0, 30.0, 20.0), half);
    vtp::write(&SurfaceOutput::plain(&surface, Frame::Unspecified)).unwrap()
}

/// Muscle everywhere.
fn ct() -> Vec<u8> {
    let steps = [Vector::x() * 20.0, Vector::y() * 20.0, Vector::z() * 20.0];
    let placement = Placement { origin: Vector::repeat(-10.0), steps };
    let image = ImageVolume::new([6, 5, 3], placement, Voxels::I16(vec![60; 90])).unwrap();
    nrrd::write(&image, Frame::Unspecified)
}

/// The small case that a block is put into, member by member.
fn with(block: &Value) -> Value {
    let mut whole = json!({
        "case": {
            "units": "mm", "volume": "face",
            "segments": [{"name": "mandible", "nodes": {"node_set": "mandible"}}],
            "fixed": [{"node_set": "skull"}],
        },
        "plan": {}, "spec": {},
    });
    for (part, members) in block.as_object().unwrap().iter().filter(|(part, _)| *part != "job") {
        let whole = whole[part].as_object_mut().unwrap_or_else(|| panic!("no document `{part}`"));
        whole.extend(members.as_object().unwrap().clone());
    }
    whole
}

async fn post_case(server: &Server, case: &Value) -> Answer {
    let text = case.to_string();
    let mut form = Form::new().part("case", Part::text(text.clone()));
    let parts = [
        ("face", face()),
        ("mandible_surface", mandible()),
        ("muscle_surface", muscle()),
        ("ct", ct()),
    ];
    for (name, bytes) in parts {
        if text.contains(&format!("\"{name}\"")) {
            form = form.part(name, Part::bytes(bytes));
        }
    }
    ask(server.post("/v1/cases").multipart(form)).await
}

#[tokio::test]
async fn the_service_takes_every_block_of_the_page_on_the_case_document() {
    let server = Server::start();
    for (heading, block) in blocks().into_iter().filter(|(_, block)| block.get("job").is_none()) {
        let whole = with(&block);
        let kept = post_case(&server, &whole["case"]).await;
        let text = String::from_utf8_lossy(&kept.bytes).into_owned();
        assert_eq!(kept.status, StatusCode::CREATED, "{heading}: {block}: {text}");
        let mut job = whole["spec"].clone();
        job["kind"] = "predict".into();
        job["case"] = kept.json()["id"].clone();
        job["plan"] = whole["plan"].clone();
        let answer = server.job(&job).await;
        let text = String::from_utf8_lossy(&answer.bytes).into_owned();
        assert!(answer.status.is_success(), "{heading}: {block}: {text}");
        let ended = server.ended(answer.json()["id"].as_str().unwrap()).await;
        assert_eq!(ended["status"], "successful", "{heading}: {ended}");
    }
}

#[tokio::test]
async fn the_service_takes_every_other_job_of_the_page_on_the_case_document() {
    let server = Server::start();
    let case = json!({"case": {"landmarks": {"pogonion": [60, 30, 20]}}});
    let case = post_case(&server, &with(&case)["case"]).await.expect(StatusCode::CREATED);
    let segments = json!([{"name": "mandible", "translation_mm": [2, 0, 0]}]);
    let predict = json!({"kind": "predict", "case": case["id"], "plan": {"segments": segments}});
    let predicted = server.job(&predict).await.expect(StatusCode::OK);
    let skin = format!("/v1/jobs/{}/results/skin.vtp", predicted["id"].as_str().unwrap());
    let skin = server.upload(ask(server.get(&skin)).await.bytes).await.expect(StatusCode::CREATED);
    let ids = [("CASE_ID", &case), ("JOB_ID", &predicted), ("MESH_ID", &skin)];
    let mut kinds = BTreeSet::new();
    for (heading, block) in blocks().into_iter().filter(|(_, block)| block.get("job").is_some()) {
        let job = ids.iter().fold(block["job"].to_string(), |text, (word, made)| {
            text.replace(word, made["id"].as_str().unwrap())
        });
        let job: Value = serde_json::from_str(&job).unwrap();
        let answer = server.job(&job).await;
        let text = String::from_utf8_lossy(&answer.bytes).into_owned();
        assert!(answer.status.is_success(), "{heading}: {block}: {text}");
        let ended = server.ended(answer.json()["id"].as_str().unwrap()).await;
        assert_eq!(ended["status"], "successful", "{heading}: {ended}");
        kinds.insert(job["kind"].as_str().unwrap().to_owned());
    }
    let wanted =
        ["compare", "learn", "optimise", "reproduce", "response", "study"].map(str::to_owned);
    assert_eq!(kinds, wanted.into());
}

/// What a reader looks for is on the page, in a block that the test above posts.
#[test]
fn the_page_on_the_case_document_shows_every_member_of_case_and_plan() {
    let mut shown: String = blocks().iter().map(|(_, block)| block.to_string()).collect();
    // Plans for scans have a page of their own.
    shown += include_str!("../../../docs/cuts.md");
    let document = facies::api::document();
    let schemas = &document["components"]["schemas"];
    for name in [
        "CaseDocument",
        "SelectionDocument",
        "SlidingDocument",
        "PlanDocument",
        "PlanSegmentDocument",
        "PrescribedDocument",
        "LoadDocument",
        "HounsfieldDocument",
        "TissueDocument",
        "MembraneDocument",
        "RegionsDocument",
        "BoneDocument",
        "MaterialDocument",
    ] {
        for member in schemas[name]["properties"].as_object().unwrap().keys() {
            let is_plain = ["schema", "name", "tags", "rotation_order"].contains(&member.as_str());
            assert!(is_plain || shown.contains(&format!("\"{member}\":")), "{name}: {member}");
        }
    }
}

#[tokio::test]
async fn a_check_without_a_body_is_that_of_a_case_in_which_nothing_moves() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = post_case(&server, &with(&json!({}))["case"]).await.expect(StatusCode::CREATED);
    let path = format!("/v1/cases/{}/check", case["id"].as_str().unwrap());
    let bare = ask(server.post(&path)).await.expect(StatusCode::OK);
    let still = ask(server.post(&path).json(&json!({}))).await.expect(StatusCode::OK);
    assert_eq!(bare, still);
    let picture = ask(server.post(&path).header("accept", "image/svg+xml")).await;
    assert_eq!(picture.status, StatusCode::OK);
    assert!(picture.bytes.starts_with(b"<svg"));
    let text = server.post(&path).header("content-type", "text/plain").body("{}");
    ask(text).await.problem(415, "unsupported-media-type");
}
