//! Landmarks of the skin that are given with a scan, and the places where its mesh is fine.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::ball_ct;

/// Points of the front of a ball of 50 mm about (60, 55, 60), from below.
const LANDMARKS: [(&str, [f64; 3]); 4] = [
    ("pogonion", [60.0, 11.7, 35.0]),
    ("sublabiale", [60.0, 6.46, 48.0]),
    ("subnasale", [60.0, 5.0, 60.0]),
    ("pronasale", [60.0, 6.46, 72.0]),
];

fn landmarks(count: usize, sign: f64) -> Value {
    let one =
        |(name, [x, y, z]): &(&str, [f64; 3])| ((*name).to_owned(), json!([sign * x, sign * y, z]));
    Value::Object(LANDMARKS.iter().take(count).map(one).collect())
}

async fn spec(server: &Server) -> Value {
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let image = ask(request.body(ball_ct())).await.expect(StatusCode::CREATED);
    let thresholds = json!({"skin": -480, "bone": 620});
    let size = json!({"finest_mm": 4, "coarsening": 2});
    json!({"kind": "mesh", "scan": image["id"], "thresholds_hu": thresholds, "size": size})
}

async fn meshed(server: &Server, spec: &Value) -> Value {
    let posted = server.job(spec).await.json();
    let job = server.ended(posted["id"].as_str().unwrap()).await;
    assert_eq!(job["status"], "successful", "{job}");
    job["results"].clone()
}

fn told<'a>(results: &'a Value, code: &str) -> Option<&'a Value> {
    results["warnings"].as_array().unwrap().iter().find(|warning| warning["code"] == code)
}

#[tokio::test]
async fn given_landmarks_bound_the_parts_of_a_skin_whose_profile_is_none_of_a_face() {
    let server = Server::start();
    let mut asked = spec(&server).await;
    let without = meshed(&server, &asked).await;
    assert!(told(&without, "no-landmarks").is_some(), "{without}");
    let parts = |results: &Value| -> Vec<String> {
        let parts = results["meshing"]["case"]["skin_regions"].as_object();
        parts.map(|parts| parts.keys().cloned().collect()).unwrap_or_default()
    };
    assert!(parts(&without).is_empty());
    for (frame, sign) in [("LPS", 1.0), ("RAS", -1.0)] {
        asked["frame"] = json!(frame);
        asked["landmarks"] = landmarks(4, sign);
        let with = meshed(&server, &asked).await;
        assert!(told(&with, "no-landmarks").is_none() && told(&with, "landmark-far").is_none());
        assert_eq!(parts(&with), ["cheeks", "chin", "lips", "nose"]);
        assert_eq!(with["meshing"]["case"]["landmarks"], landmarks(4, 1.0), "{frame}");
        // Cells about lips and nose are as fine as any.
        let cells = |results: &Value| results["meshing"]["tetrahedra"].as_f64().unwrap();
        assert!(cells(&with) > 1.1 * cells(&without), "{} {}", cells(&with), cells(&without));
    }
    asked["landmarks"] = landmarks(3, -1.0);
    assert_eq!(parts(&meshed(&server, &asked).await), ["cheeks", "chin", "lips"]);
    asked["landmarks"]["pogonion"][1] = json!(40);
    let far = meshed(&server, &asked).await;
    let far = told(&far, "landmark-far").unwrap();
    assert!(far["detail"].as_str().unwrap().contains("pogonion"), "{far}");
    assert!((48.0..55.0).contains(&far["distance_mm"].as_f64().unwrap()), "{far}");
}

#[tokio::test]
async fn landmarks_that_are_those_of_no_face_are_refused_with_their_place() {
    let server = Server::start();
    let sound = spec(&server).await;
    for (name, axis, value, at) in [
        ("sublabiale", 2, 30.0, "/landmarks/sublabiale"),
        ("pogonion", 0, 100.0, "/landmarks/pogonion"),
        ("subnasale", 1, 1e9, "/landmarks/subnasale/1"),
    ] {
        let mut asked = sound.clone();
        asked["landmarks"] = landmarks(4, 1.0);
        asked["landmarks"][name][axis] = json!(value);
        let problem = server.job(&asked).await.problem(422, "validation-failed");
        assert_eq!(problem["errors"][0]["pointer"], at, "{problem}");
        assert_eq!(problem["errors"][0]["code"], "out-of-range", "{problem}");
    }
}

#[tokio::test]
async fn cells_are_fine_in_the_places_that_are_named() {
    let server = Server::start();
    let mut asked = spec(&server).await;
    let cells = |results: &Value| results["meshing"]["tetrahedra"].as_f64().unwrap();
    let coarse = cells(&meshed(&server, &asked).await);
    // The left half.
    asked["size"]["fine"] = json!([{"box_mm": [60, 0, 0, 120, 110, 120]}]);
    let half = cells(&meshed(&server, &asked).await);
    asked["size"]["fine"] = json!([{"sphere_mm": [60, 55, 60, 60]}]);
    let fine = cells(&meshed(&server, &asked).await);
    assert!(coarse * 1.3 < half && half * 1.3 < fine, "{coarse} {half} {fine}");
    asked["size"]["fine"] = json!([{"sphere_mm": [60, 55, 60, -1]}]);
    let problem = server.job(&asked).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/size/fine/0/sphere_mm/3", "{problem}");
}
