//! Scans that become meshes: a job whose mesh and case are there for predictions.

use mechanics::mesh::Vector;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::{ball_ct, ball_ct_with};

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

/// Enamel on the front of the lower half of the bone.
fn toothed_ct() -> Vec<u8> {
    let middle = Vector::new(60.0, 55.0, 60.0);
    ball_ct_with(|at| {
        let depth = 30.0 - (at - middle).norm();
        let is_tooth = (1.0..7.0).contains(&depth) && at.y < 40.0 && (44.0..56.0).contains(&at.z);
        is_tooth.then_some(2600)
    })
}

#[tokio::test]
async fn tissue_slides_on_teeth_that_go_with_their_bone_unless_it_is_told_not_to() {
    let server = Server::start();
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let scan = ask(request.body(toothed_ct())).await.expect(StatusCode::CREATED);
    let mut asked = spec(scan["id"].as_str().unwrap());
    let slides = ended(&server, &asked).await["results"]["meshing"].clone();
    let sets = &slides["node_sets"];
    assert!(sets["sliding_jaw"].as_u64().unwrap() > 10, "{sets}");
    assert!(sets["jaw"].as_u64() > sets["sliding_jaw"].as_u64(), "{sets}");
    let wall =
        json!([{"nodes": {"node_set": "sliding_jaw"}, "normal": "surface", "segment": "jaw"}]);
    assert_eq!(slides["case"]["sliding"], wall);
    asked["teeth_slide"] = json!(false);
    let joined = ended(&server, &asked).await["results"]["meshing"].clone();
    assert_eq!(joined["node_sets"].get("sliding_jaw"), None);
    assert_eq!(joined["case"].get("sliding"), None);
    let both = sets["jaw"].as_u64().unwrap() + sets["sliding_jaw"].as_u64().unwrap();
    assert_eq!(joined["node_sets"]["jaw"].as_u64(), Some(both));

    // The wall goes with its bone.
    let case =
        ask(server.post("/v1/cases").json(&slides["case"])).await.expect(StatusCode::CREATED);
    assert!(case["check"]["classes"]["sliding"].as_u64() > Some(10), "{case}");
    let plan = json!({"segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}]});
    let predicted =
        ended(&server, &json!({"kind": "predict", "case": case["id"], "plan": plan})).await;
    assert_eq!(predicted["status"], "successful", "{predicted}");
    let largest = predicted["results"]["statistics"]["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!((1.5..4.0).contains(&largest), "{largest}");
}

#[tokio::test]
async fn a_region_around_segments_has_fewer_cells_of_the_same_size_and_tells_what_it_leaves_out() {
    let server = Server::start();
    let scan = scan(&server).await;
    let mut asked = spec(&scan);
    asked["osteotomy"]["cuts"][0]["point_mm"] = json!([60, 55, 45]);
    asked["size"] = json!({"finest_mm": 6, "coarsening": 1});
    let whole = ended(&server, &asked).await["results"].clone();
    asked["region"] = json!({"around_segments_mm": 30});
    let part = ended(&server, &asked).await["results"].clone();
    let warning =
        part["warnings"].as_array().unwrap().iter().find(|w| w["code"] == "tissue-cut-off");
    let told = warning.unwrap()["volume_ml"].as_f64().unwrap();
    let volume = |results: &Value| results["meshing"]["volume_ml"].as_f64().unwrap();
    let less = volume(&whole) - volume(&part);
    assert!((told / less - 1.0).abs() < 0.1, "{told} of {less} ml");
    let cells = |results: &Value| results["meshing"]["tetrahedra"].as_f64().unwrap();
    let shares = (cells(&part) / cells(&whole), volume(&part) / volume(&whole));
    assert!((shares.0 / shares.1 - 1.0).abs() < 0.15, "{shares:?}");
    let fixed = |results: &Value| results["meshing"]["node_sets"]["fixed"].as_u64().unwrap();
    assert!(fixed(&part) > 0, "what is left ends in nodes that are held");
    asked.as_object_mut().unwrap().remove("osteotomy");
    let problem = server.job(&asked).await.problem(422, "unknown-segment");
    assert_eq!(problem["errors"][0]["pointer"], "/region/around_segments_mm");
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
    assert_eq!(job["error"]["errors"][0]["pointer"], "/spec/osteotomy/segments/0", "{job}");
    let mut beside = spec(&scan);
    beside["osteotomy"]["segments"][0]["seeds_mm"] = json!([[60, 55, 50], [1, 1, 1]]);
    let job = ended(&server, &beside).await;
    let told = &job["error"]["errors"][0]["pointer"];
    assert_eq!(told, "/spec/osteotomy/segments/0/seeds_mm/1", "{job}");
}
