//! Scans that become meshes: a job whose mesh and case are there for predictions.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::{BONE_BALL, SKIN_BALL, SampleBall, ball_ct, ball_stl};

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

async fn surface(server: &Server, ball: SampleBall) -> String {
    let kept = server.upload(ball_stl(ball)).await.expect(StatusCode::CREATED);
    kept["id"].as_str().unwrap().to_owned()
}

#[tokio::test]
async fn surfaces_become_a_case_by_cuts_or_as_segments() {
    let server = Server::start();
    let [skin, bone] = [surface(&server, SKIN_BALL).await, surface(&server, BONE_BALL).await];
    let cut = json!({"kind": "mesh", "surfaces": {"skin": skin, "bone": bone}, "frame": "LPS",
        "osteotomy": half(), "size": {"tetrahedra": 20_000}});
    let job = ended(&server, &cut).await;
    assert_eq!(job["status"], "successful", "{job}");
    let made = &job["results"]["meshing"];
    let volume = made["volume_ml"].as_f64().unwrap();
    assert!((volume / 410.5 - 1.0).abs() < 0.02, "{volume}");
    let half = made["segments"][0]["volume_ml"].as_f64().unwrap();
    assert!((half / 56.55 - 1.0).abs() < 0.02, "{half}");
    assert_eq!(made["case"]["frame"], "LPS");
    let inputs = job["results"]["provenance"]["inputs"].as_array().unwrap();
    let roles: Vec<&Value> = inputs.iter().map(|input| &input["role"]).collect();
    assert_eq!(roles, ["skin", "bone"]);

    let bones = json!([{"name": "jaw", "mesh": bone}]);
    let given = json!({"kind": "mesh", "surfaces": {"skin": skin, "bones": bones},
        "size": {"tetrahedra": 20_000}});
    let job = ended(&server, &given).await;
    let made = &job["results"]["meshing"];
    let whole = made["segments"][0]["volume_ml"].as_f64().unwrap();
    assert!((whole / 113.1 - 1.0).abs() < 0.02, "{whole} {job}");
    assert!(made["node_sets"]["jaw"].as_u64() > Some(300) && made["node_sets"]["fixed"].is_null());
}

#[tokio::test]
async fn surfaces_that_bound_no_tissue_are_refused_with_their_place() {
    let server = Server::start();
    let [skin, bone] = [surface(&server, SKIN_BALL).await, surface(&server, BONE_BALL).await];
    let sound = json!({"kind": "mesh", "surfaces": {"skin": skin, "bone": bone}});
    let refused = async |change: &dyn Fn(&mut Value), at: &str, code: &str| {
        let mut asked = sound.clone();
        change(&mut asked);
        let problem = server.job(&asked).await.problem(422, "validation-failed");
        let fault = &problem["errors"][0];
        assert_eq!((&fault["pointer"], &fault["code"]), (&json!(at), &json!(code)), "{problem}");
    };
    let named = json!([{"name": "jaw", "mesh": bone}]);
    refused(&|asked| asked["scan"] = json!(skin), "", "one-of").await;
    refused(&|asked| asked["surfaces"]["bones"] = named.clone(), "/surfaces", "one-of").await;
    refused(&|asked| asked["surfaces"]["skin"] = json!("x"), "/surfaces/skin", "unknown-mesh")
        .await;
    let thresholds = json!({"skin": -200});
    refused(&|asked| asked["thresholds_hu"] = thresholds.clone(), "/thresholds_hu", "no-scan")
        .await;
    let cut_again = |asked: &mut Value| {
        asked["surfaces"] = json!({"skin": skin, "bones": named});
        asked["osteotomy"] = half();
    };
    refused(&cut_again, "/osteotomy", "one-of").await;
    let reserved = |asked: &mut Value| {
        asked["surfaces"] = json!({"skin": skin, "bones": [{"name": "fixed", "mesh": bone}]});
    };
    refused(&reserved, "/surfaces/bones", "bad-name").await;

    // A sixth of its triangles is no skin.
    let whole = String::from_utf8(ball_stl(SKIN_BALL)).unwrap();
    let facets: Vec<&str> = whole.split_inclusive("endfacet\n").step_by(6).collect();
    let sixth = format!("{}endsolid ball\n", facets.concat());
    let kept = server.upload(sixth.into_bytes()).await.expect(StatusCode::CREATED);
    let mut asked = sound.clone();
    asked["surfaces"]["skin"] = kept["id"].clone();
    let job = ended(&server, &asked).await;
    assert_eq!(job["error"]["type"], "no-inside", "{job}");
    assert_eq!(job["error"]["errors"][0]["pointer"], "/spec/surfaces/skin", "{job}");
}
