//! Bone of a scan that is made whole before it is cut.

use serde_json::{Value, json};

use crate::helpers::{Server, ask};
use crate::samples::ball_ct_with;

/// Half of a bone of 30 mm, of whose voxels some are tissue: what is asked of bone, and the volume of the segment in ml.
async fn segment_of(
    server: &Server,
    is_gap: fn([f64; 3]) -> bool,
    whole_bone: Option<Value>,
) -> (f64, Value) {
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let scan = ball_ct_with(|at| is_gap([at.x, at.y, at.z]).then_some(40));
    // One that is there already is found again.
    let image = ask(request.body(scan)).await.json();
    let mut asked = json!({"kind": "mesh", "scan": image["id"], "size": {"tetrahedra": 20_000},
        "thresholds_hu": {"skin": -480, "bone": 620},
        "osteotomy": {"cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
            "segments": [{"name": "jaw", "below": ["middle"]}]}});
    if let Some(whole_bone) = whole_bone {
        asked["whole_bone"] = whole_bone;
    }
    let posted = server.job(&asked).await.json();
    let job = server.ended(posted["id"].as_str().unwrap()).await;
    assert_eq!(job["status"], "successful", "{job}");
    let results = &job["results"];
    let volume = results["meshing"]["segments"][0]["volume_ml"].as_f64().unwrap();
    let warnings = results["warnings"].as_array().unwrap();
    let told = warnings.iter().find(|warning| warning["code"] == "bone-made-whole");
    (volume, told.cloned().unwrap_or_default())
}

/// Of half the bone, in ml.
const HALF: f64 = 56.55;

#[tokio::test]
async fn a_gap_of_one_voxel_is_closed_where_that_is_asked_for() {
    let server = Server::start();
    // A slice of voxels across the bone, beside its middle.
    let slit = |[x, y, z]: [f64; 3]| {
        (x - 58.0).abs() < 1.0 && (x - 60.0).hypot(y - 55.0).hypot(z - 60.0) < 31.0
    };
    let (parted, told) = segment_of(&server, slit, None).await;
    assert!(parted < 0.6 * HALF && told.is_null(), "{parted} {told}");
    let (closed, told) = segment_of(&server, slit, Some(json!({"closing_mm": 4.5}))).await;
    assert!((closed / HALF - 1.0).abs() < 0.1, "{closed}");
    // A disc of 27.5 mm and 4 mm: the rest is a notch that a ball of 4.5 mm fits into.
    let volume = told["volume_ml"].as_f64().unwrap();
    assert!((volume / 9.5 - 1.0).abs() < 0.2, "{told}");
}

#[tokio::test]
async fn marrow_is_bone_where_that_is_asked_for() {
    let server = Server::start();
    let marrow = |[x, y, z]: [f64; 3]| (x - 60.0).hypot(y - 55.0).hypot(z - 60.0) < 16.0;
    let (hollow, told) = segment_of(&server, marrow, None).await;
    assert!(hollow < 0.9 * HALF && told.is_null(), "{hollow} {told}");
    let (filled, told) = segment_of(&server, marrow, Some(json!({"fill_holes": true}))).await;
    assert!((filled / HALF - 1.0).abs() < 0.1, "{filled}");
    // A ball of 16 mm.
    let volume = told["volume_ml"].as_f64().unwrap();
    assert!((volume / 17.2 - 1.0).abs() < 0.15, "{told}");
}
