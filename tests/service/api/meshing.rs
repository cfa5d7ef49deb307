//! Scans that become meshes: a job whose mesh and case are there for predictions.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::ball_ct;

/// The lower half of the bone comes loose.
fn half() -> Value {
    json!({
        "cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
        "segments": [{"name": "jaw", "below": ["middle"]}],
    })
}

async fn scan(server: &Server) -> String {
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let image = ask(request.body(ball_ct())).await.expect(StatusCode::CREATED);
    image["id"].as_str().unwrap().to_owned()
}

fn spec(scan: &str) -> Value {
    // Half way between the values on either side, so that boundaries are where the balls have them.
    let thresholds = json!({"skin": -480, "bone": 620});
    json!({"kind": "mesh", "scan": scan, "thresholds_hu": thresholds, "osteotomy": half(),
        "size": {"tetrahedra": 20_000}})
}

async fn ended(server: &Server, spec: &Value) -> Value {
    let posted = server.job(spec).await.json();
    server.ended(posted["id"].as_str().unwrap()).await
}

#[tokio::test]
async fn a_scan_becomes_a_case_on_which_a_plan_is_predicted() {
    let server = Server::start();
    let scan = scan(&server).await;
    let job = ended(&server, &spec(&scan)).await;
    assert_eq!(job["status"], "successful", "{job}");
    let made = &job["results"]["meshing"];
    // 4/3 pi (50^3 - 30^3) mm3.
    let volume = made["volume_ml"].as_f64().unwrap();
    assert!((volume / 410.5 - 1.0).abs() < 0.02, "{volume}");
    let bone = &made["segments"][0];
    let half = bone["volume_ml"].as_f64().unwrap();
    assert_eq!(bone["name"], "jaw");
    assert!((half / 56.55 - 1.0).abs() < 0.1, "{half}");
    let kept = job["results"]["kept"].as_array().unwrap();
    let names: Vec<&Value> = kept.iter().map(|mesh| &mesh["what"]).collect();
    assert_eq!(names, ["volume", "bone"]);
    assert_eq!(made["case"]["volume"], kept[0]["mesh"]);
    assert_eq!(made["case"]["bones"], json!([{"name": "jaw", "mesh": kept[1]["mesh"]}]));

    let case = ask(server.post("/v1/cases").json(&made["case"])).await.expect(StatusCode::CREATED);
    let plan = json!({"segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}]});
    let asked = json!({"kind": "predict", "case": case["id"], "plan": plan});
    let predicted = ended(&server, &asked).await;
    assert_eq!(predicted["status"], "successful", "{predicted}");
    let largest = predicted["results"]["statistics"]["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!((2.0..4.0).contains(&largest), "{largest}");
}

#[tokio::test]
async fn what_cannot_be_meshed_is_refused_with_its_place() {
    let server = Server::start();
    let scan = scan(&server).await;
    let refused = async |change: &dyn Fn(&mut Value), code: &str, at: &str| {
        let mut asked = spec(&scan);
        change(&mut asked);
        let problem = server.job(&asked).await.problem(422, code);
        assert_eq!(problem["errors"][0]["pointer"], at, "{problem}");
    };
    let unknown =
        |asked: &mut Value| asked["osteotomy"]["segments"][0]["below"] = json!(["nowhere"]);
    refused(&unknown, "validation-failed", "/osteotomy/segments/0/below/0").await;
    let both = |asked: &mut Value| asked["size"]["finest_mm"] = json!(4);
    refused(&both, "validation-failed", "/size").await;
    let nothing = |asked: &mut Value| asked["scan"] = json!("none");
    refused(&nothing, "validation-failed", "/scan").await;

    let mut empty = spec(&scan);
    empty.as_object_mut().unwrap().remove("osteotomy");
    empty["thresholds_hu"] = json!({"skin": 3000, "bone": 4000});
    let job = ended(&server, &empty).await;
    assert_eq!((&job["status"], &job["error"]["type"]), (&json!("failed"), &json!("no-tissue")));
    assert!(job["error"]["detail"].as_str().unwrap().contains("3000"), "{job}");
    let mut no_bone = spec(&scan);
    no_bone["osteotomy"]["cuts"][0]["point_mm"] = json!([60, 55, -500]);
    let job = ended(&server, &no_bone).await;
    assert_eq!(job["error"]["type"], "segment-not-found", "{job}");
}
