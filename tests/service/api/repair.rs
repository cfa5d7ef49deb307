//! Meshes of clients with distorted cells, repaired where their case asks for it.

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, VolumeMesh, sample};
use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask};

/// A block of cells of 6 mm, of which some inner nodes went over their neighbours: the cells there have a corner that is
/// inverted, and Gauss points that are not where nodes went by 6.3 mm.
fn dented(cells: usize, by: f64, is_moved: impl Fn([usize; 3]) -> bool) -> VolumeMesh {
    let size = 6.0 * cells as f64;
    let mut mesh = sample::block(Vector::repeat(size), [cells; 3], CellShape::Hex8);
    for node in &mut mesh.nodes {
        let place = [0, 1, 2].map(|axis| (node[axis] / 6.0).round() as usize);
        if place.iter().all(|&at| at > 0 && at < cells) && is_moved(place) {
            node.x += by;
        }
    }
    mesh
}

fn one() -> VolumeMesh {
    dented(4, 6.3, |place| place == [2, 2, 2])
}

async fn posted(server: &Server, mesh: &VolumeMesh, repair: &Value) -> Answer {
    let mut case = SMALL.case();
    case["repair"] = repair.clone();
    if repair.is_null() {
        case.as_object_mut().unwrap().remove("repair");
    }
    case["landmarks"] = json!({});
    let volume = vtu::write(&VolumeOutput::plain(mesh, Frame::Unspecified)).unwrap();
    let form = Form::new().part("case", Part::text(case.to_string()));
    let form = form.part("block", Part::bytes(volume));
    ask(server.post("/v1/cases").multipart(form)).await
}

fn codes(told: &Value) -> Vec<&str> {
    told["warnings"].as_array().unwrap().iter().map(|own| own["code"].as_str().unwrap()).collect()
}

#[tokio::test]
async fn a_case_with_distorted_cells_is_repaired_where_it_asks_for_that() {
    let server = Server::start();
    let plain = posted(&server, &one(), &Value::Null).await.expect(StatusCode::CREATED);
    assert!(codes(&plain["check"]).contains(&"mesh-inverted-elements"), "{plain}");
    assert!(plain["check"]["repair"].is_null());

    let kept = posted(&server, &one(), &json!({})).await.expect(StatusCode::CREATED);
    let repair = &kept["check"]["repair"];
    assert_eq!(
        (&repair["unproven_before"], &repair["unproven"]),
        (&json!(4), &json!([])),
        "{kept}"
    );
    let largest = repair["largest_move_mm"].as_f64().unwrap();
    assert!((0.3..3.0 + 1e-9).contains(&largest), "{repair}");
    let told = codes(&kept["check"]);
    assert!(told.contains(&"mesh-repaired") && !told.contains(&"mesh-inverted-elements"), "{kept}");

    let plan = json!({"segments": [{"name": "bone", "translation_mm": [0, 0, 1]}]});
    let job = server.job(&json!({"kind": "predict", "case": kept["id"], "plan": plan})).await;
    let job = job.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    assert!(codes(&job["results"]).contains(&"mesh-repaired"), "{job}");

    let case = kept["id"].as_str().unwrap();
    server.job(&json!({"kind": "response", "case": case})).await.expect(StatusCode::OK);
    let path = format!("/v1/cases/{case}/response/apply");
    let applied = ask(server.post(&path).json(&json!({"plan": plan}))).await;
    assert!(codes(&applied.expect(StatusCode::OK)).contains(&"mesh-repaired"));
}

#[tokio::test]
async fn what_no_repair_mends_is_named_and_a_mesh_of_distorted_cells_is_refused() {
    let server = Server::start();
    let still = json!({"boundary_mm": 0, "inner_mm": 0});
    let kept = posted(&server, &one(), &still).await.expect(StatusCode::CREATED);
    let repair = &kept["check"]["repair"];
    let unproven = repair["unproven"].as_array().unwrap();
    assert_eq!((unproven.len(), &repair["nodes_moved"]), (4, &json!(0)), "{repair}");
    assert!(unproven.iter().all(|own| own["smallest_jacobian_mm3"].as_f64() < Some(0.0)));
    let told = codes(&kept["check"]);
    assert!(told.contains(&"mesh-repaired") && told.contains(&"mesh-inverted-elements"), "{kept}");

    let far = posted(&server, &one(), &json!({"inner_mm": 11})).await;
    let problem = far.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/repair/inner_mm", "{problem}");

    let many = dented(8, 6.3, |place| place.iter().all(|at| at % 2 == 0));
    let problem = posted(&server, &many, &json!({})).await.problem(422, "validation-failed");
    let fault = &problem["errors"][0];
    assert_eq!(
        (&fault["pointer"], &fault["code"]),
        (&json!("/repair"), &json!("mesh-inverted-elements")),
        "{problem}"
    );
}

#[tokio::test]
async fn cells_that_are_inverted_where_they_are_integrated_are_taken_for_repair_alone() {
    let server = Server::start();
    let folded = dented(4, 10.0, |place| place == [2, 2, 2]);
    let problem = posted(&server, &folded, &Value::Null).await.problem(422, "validation-failed");
    let fault = &problem["errors"][0];
    assert_eq!(
        (&fault["pointer"], &fault["code"]),
        (&json!("/volume"), &json!("mesh-inverted-elements")),
        "{problem}"
    );
    assert!(fault["detail"].as_str().unwrap().contains("of 64 cells"), "{problem}");

    // No moves mend nothing.
    let still = json!({"boundary_mm": 0, "inner_mm": 0});
    let little = posted(&server, &folded, &still).await;
    let problem = little.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/repair", "{problem}");
    let kept = posted(&server, &folded, &json!({"inner_mm": 6})).await.expect(StatusCode::CREATED);
    assert_eq!(kept["check"]["repair"]["unproven"], json!([]), "{kept}");
    let told = codes(&kept["check"]);
    assert!(told.contains(&"mesh-repaired") && !told.contains(&"mesh-inverted-elements"), "{kept}");
    let plan = json!({"segments": [{"name": "bone", "translation_mm": [0, 0, 1]}]});
    let job = server.job(&json!({"kind": "predict", "case": kept["id"], "plan": plan})).await;
    assert_eq!(job.expect(StatusCode::OK)["status"], "successful");
}
