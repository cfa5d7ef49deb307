//! Scans that become meshes: a job whose mesh and case are there for predictions.

use mechanics::mesh::Vector;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::{
    BONE_BALL, SKIN_BALL, SampleBall, ball_ct, ball_ct_with, ball_labels, ball_stl,
};

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
async fn thresholds_are_found_in_the_histogram_of_the_scan() {
    let server = Server::start();
    let mut asked = spec(&scan(&server).await);
    let stated = ended(&server, &asked).await;
    let found = &stated["results"]["meshing"]["thresholds_hu"];
    assert_eq!(found, &json!({"skin": -480.0, "bone": 620.0}), "{stated}");
    asked["thresholds_hu"] = json!("auto");
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    // Between air at -1000 HU, tissue at 40 HU and bone at 1200 HU; skin and bone are within a quarter of a voxel of 4 mm, so that
    // of 4/3 pi (50^3 - 30^3) mm3 at most 8 % are missing.
    let made = &job["results"]["meshing"];
    let found = |name: &str| made["thresholds_hu"][name].as_f64().unwrap();
    assert!((-600.0..-300.0).contains(&found("skin")), "{made}");
    assert!((190.0..640.0).contains(&found("bone")), "{made}");
    let volume = made["volume_ml"].as_f64().unwrap();
    assert!((volume / 410.5 - 1.0).abs() < 0.08, "{volume}");
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
async fn a_meshing_that_takes_more_memory_than_its_budget_is_ended() {
    let server = Server::start();
    let mut spec = spec(&scan(&server).await);
    spec["size"] = json!({"tetrahedra": 300_000});
    spec["budget"] = json!({"memory_mb": 1});
    let failed = ended(&server, &spec).await;
    let error = &failed["error"];
    assert_eq!(
        (&failed["status"], &error["type"], &error["which"]),
        (&json!("failed"), &json!("budget-exceeded"), &json!("memory")),
        "{failed}"
    );
    assert_eq!(error["allowed_mb"], 1.0, "{error}");
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
    assert_eq!(job["error"]["errors"][0]["pointer"], "/osteotomy/segments/0", "{job}");
    let mut beside = spec(&scan);
    beside["osteotomy"]["segments"][0]["seeds_mm"] = json!([[60, 55, 50], [1, 1, 1]]);
    let job = ended(&server, &beside).await;
    let told = &job["error"]["errors"][0]["pointer"];
    assert_eq!(told, "/osteotomy/segments/0/seeds_mm/1", "{job}");
    // A disc in a ball of bone of 30 mm, around which the jaw hangs at the rest, and a line that is not sawn through.
    let disc = json!({"cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1], "radius_mm": 15}],
        "segments": [{"name": "jaw", "below": ["middle"], "seeds_mm": [[60, 55, 50]]}]});
    let line = json!({"polylines": [{"name": "step", "polyline_mm": [[20, 15, 60], [100, 15, 60]],
            "direction": [0, 1, 0], "depth_mm": 40}],
        "segments": [{"name": "jaw", "below": ["step"], "seeds_mm": [[60, 55, 50]]}]});
    for (osteotomy, place) in [(disc, "cuts/0"), (line, "polylines/0")] {
        let mut hanging = spec(&scan);
        hanging["osteotomy"] = osteotomy;
        let job = ended(&server, &hanging).await;
        assert_eq!(job["error"]["type"], "validation-failed", "{job}");
        let error = &job["error"]["errors"][0];
        assert_eq!(error["code"], "cut-leaves-bridge", "{job}");
        assert_eq!(error["pointer"], format!("/osteotomy/{place}"), "{job}");
        assert!(error["detail"].as_str().unwrap().contains("still hangs at"), "{job}");
    }
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

/// The same bytes, of which an upload says where their axes are, or the unit of a face.
#[tokio::test]
async fn the_same_surface_in_another_frame_is_another_job() {
    let server = Server::start_with(&["--workers", "0"]);
    let uploaded = async |stated: &str, ball: SampleBall| {
        let request = server.post(&format!("/v1/meshes?allow_any_scale=true&{stated}"));
        let request = request.header("content-type", "model/stl").body(ball_stl(ball));
        ask(request).await.expect(StatusCode::CREATED)["id"].clone()
    };
    let mut meshings = Vec::new();
    let mut comparisons = Vec::new();
    for stated in ["frame=LPS", "frame=RAS", "units=um"] {
        let [skin, bone] = [uploaded(stated, SKIN_BALL).await, uploaded(stated, BONE_BALL).await];
        let mesh = json!({"kind": "mesh", "surfaces": {"skin": skin, "bone": bone}});
        let compare =
            json!({"kind": "compare", "prediction": {"mesh": skin}, "actual": {"mesh": bone}});
        for (asked, jobs) in [(mesh, &mut meshings), (compare, &mut comparisons)] {
            let answer = ask(server.post("/v1/jobs").json(&asked)).await;
            jobs.push(answer.expect(StatusCode::CREATED)["id"].clone());
            let again = ask(server.post("/v1/jobs").json(&asked)).await.json();
            assert_eq!(jobs.last(), Some(&again["id"]), "{stated}");
        }
    }
    for jobs in [meshings, comparisons] {
        assert!(jobs[0] != jobs[1] && jobs[1] != jobs[2] && jobs[0] != jobs[2], "{jobs:?}");
    }
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
    let closing = json!({"closing_mm": 2.0});
    refused(&|asked| asked["whole_bone"] = closing.clone(), "/whole_bone/closing_mm", "no-scan")
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
    assert_eq!(job["error"]["errors"][0]["pointer"], "/surfaces/skin", "{job}");

    let twice = json!([{"name": "jaw", "mesh": bone}, {"name": "skull", "mesh": bone}]);
    let asked = json!({"kind": "mesh", "surfaces": {"skin": skin, "bones": twice}});
    let job = ended(&server, &asked).await;
    let fault = &job["error"]["errors"][0];
    assert_eq!(fault["code"], "segment-not-found", "{job}");
    assert!(fault["pointer"].as_str().unwrap().starts_with("/surfaces/bones/"), "{job}");
    assert!(fault["detail"].as_str().unwrap().contains("is the same surface as bone"), "{job}");
}

#[tokio::test]
async fn a_scan_without_cuts_gives_a_case_whose_bone_is_fixed() {
    let server = Server::start();
    let scan = scan(&server).await;
    let mut asked = spec(&scan);
    asked.as_object_mut().unwrap().remove("osteotomy");
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    let listed = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"][0]["id"], job["id"], "{listed}");
    let case = &job["results"]["meshing"]["case"];
    let kept = ask(server.post("/v1/cases").json(case)).await.expect(StatusCode::CREATED);
    assert!(kept["check"]["classes"]["fixed"].as_u64() > Some(300), "{kept}");
}

#[tokio::test]
async fn a_scan_without_bone_is_meshed_and_says_so() {
    let server = Server::start();
    let scan = scan(&server).await;
    // The highest value: between voxels the smoothed scan is above it.
    let asked = json!({"kind": "mesh", "scan": scan, "thresholds_hu": {"skin": -480, "bone": 1200},
        "size": {"tetrahedra": 5000}});
    let job = ended(&server, &asked).await;
    let warnings = job["results"]["warnings"].as_array().unwrap();
    let told: Vec<&Value> = warnings.iter().filter(|own| own["code"] == "no-bone").collect();
    let [told] = told[..] else { panic!("{job}") };
    assert_eq!(told["highest"], json!(1200.0), "{job}");
    assert!(told["detail"].as_str().unwrap().contains("threshold of bone, 1200 HU"), "{job}");
    let of_bone = ["nodes-off-bone", "thin-bone-lost", "no-cuts"].map(Value::from);
    assert!(!warnings.iter().any(|own| of_bone.contains(&own["code"])), "{job}");
}

#[tokio::test]
async fn a_cut_beside_all_bone_is_reported() {
    let server = Server::start();
    let scan = scan(&server).await;
    let mut asked = spec(&scan);
    asked["osteotomy"]["cuts"][0]["point_mm"] = json!([60, 55, 500]);
    let beside = ended(&server, &asked).await;
    let told = |job: &Value| {
        let warnings = job["results"]["warnings"].as_array().unwrap().clone();
        let missed: Vec<Value> =
            warnings.into_iter().filter(|w| w["code"] == "cut-meets-no-bone").collect();
        missed
    };
    let missed = told(&beside);
    assert!(missed[0]["detail"].as_str().unwrap().contains("`middle`"), "{beside}");
    assert!(told(&ended(&server, &spec(&scan)).await).is_empty());
}

#[tokio::test]
async fn values_that_are_no_hounsfield_units_are_not_taken_for_a_head() {
    let server = Server::start();
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let all_tissue = ball_ct_with(|_| Some(40));
    let scan = ask(request.body(all_tissue)).await.expect(StatusCode::CREATED);
    let asked = json!({"kind": "mesh", "scan": scan["id"], "size": {"tetrahedra": 5000}});
    let job = ended(&server, &asked).await;
    assert_eq!(job["error"]["type"], "no-tissue", "{job}");
    assert!(job["error"]["detail"].as_str().unwrap().contains("outer skin"), "{job}");

    let with = |thresholds: Value| json!({"kind": "mesh", "scan": scan["id"], "thresholds_hu": thresholds});
    for (thresholds, code) in [
        (json!({"skin": 250, "bone": -300}), "out-of-range"),
        (json!("auto"), "no-thresholds"),
        (json!("otsu"), "unknown-word"),
    ] {
        let problem = server.job(&with(thresholds)).await.problem(422, "validation-failed");
        let fault = &problem["errors"][0];
        assert_eq!(
            (&fault["pointer"], &fault["code"]),
            (&json!("/thresholds_hu"), &json!(code)),
            "{problem}"
        );
    }
}

#[tokio::test]
async fn no_segment_is_called_like_a_part_of_the_skin() {
    let server = Server::start();
    let mut asked = spec(&scan(&server).await);
    asked["osteotomy"]["segments"][0]["name"] = json!("skin_chin");
    let problem = server.job(&asked).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["code"], "bad-name", "{problem}");
}

#[tokio::test]
async fn a_label_map_becomes_a_case_with_a_material_for_each_region() {
    let server = Server::start();
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let image = ask(request.body(ball_labels())).await.expect(StatusCode::CREATED);
    let classes = json!([
        {"label": "1", "is": "tissue", "name": "muscle"},
        {"label": "2", "is": "tissue", "name": "fat"},
        {"label": "3", "is": "bone", "name": "jaw"},
    ]);
    let asked = json!({"kind": "mesh", "labels": {"image": image["id"], "classes": classes},
        "size": {"tetrahedra": 20_000}});
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    let made = &job["results"]["meshing"];
    // 4/3 pi (50^3 - 30^3) mm3.
    let volume = made["volume_ml"].as_f64().unwrap();
    assert!((volume / 410.5 - 1.0).abs() < 0.02, "{volume}");
    let mut case = made["case"].clone();
    case["materials"] = json!({"muscle": {"young_modulus_kpa": 30, "poisson_ratio": 0.46}, "fat": {"young_modulus_kpa": 3, "poisson_ratio": 0.46}});
    let kept = ask(server.post("/v1/cases").json(&case)).await.expect(StatusCode::CREATED);
    assert_eq!(kept["check"]["classes"]["fixed"], 0, "{kept}");

    let refused = async |change: &dyn Fn(&mut Value), code: &str, at: &str| {
        let mut wrong = asked.clone();
        change(&mut wrong);
        let problem = server.job(&wrong).await.problem(422, "validation-failed");
        let fault = &problem["errors"][0];
        assert_eq!((&fault["pointer"], &fault["code"]), (&json!(at), &json!(code)), "{problem}");
    };
    let short = |asked: &mut Value| {
        asked["labels"]["classes"].as_array_mut().unwrap().remove(1);
    };
    refused(&short, "unknown-label", "/labels/classes").await;
    let foreign = |asked: &mut Value| asked["labels"]["classes"][0]["label"] = json!("masseter");
    refused(&foreign, "unknown-label", "/labels/classes/0/label").await;
    let twice = |asked: &mut Value| asked["labels"]["classes"][1]["label"] = json!("1");
    refused(&twice, "duplicate-name", "/labels/classes/1/label").await;
    let cut = |asked: &mut Value| asked["osteotomy"] = half();
    refused(&cut, "one-of", "/osteotomy").await;
    let solid = |asked: &mut Value| {
        let classes = asked["labels"]["classes"].as_array_mut().unwrap();
        classes.iter_mut().for_each(|class| class["is"] = json!("bone"));
    };
    refused(&solid, "missing-field", "/labels/classes").await;
}
