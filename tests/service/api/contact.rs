//! Contact over HTTP: what a spec asks for, what the result and its files tell of it, and who refuses it.

use reqwest::StatusCode;
use serde_json::{Value, json};

use super::response::lips;
use crate::helpers::{Server, ask};

/// The case of two lips 1 mm apart, and the lower one raised by 3 mm.
async fn case(server: &Server) -> String {
    let upload = server.post("/v1/meshes?units=mm");
    let upload = upload.header("content-type", "application/octet-stream").body(lips());
    let mesh = ask(upload).await.expect(StatusCode::CREATED);
    let case = json!({"units": "mm", "volume": mesh["id"], "skin": {"node_set": "skin"},
        "allow_unfixed": true, "segments": [{"name": "jaw", "nodes": {"node_set": "z_min"}}],
        "fixed": [{"node_set": "ceiling"}]});
    let case = ask(server.post("/v1/cases").json(&case)).await.expect(StatusCode::CREATED);
    case["id"].as_str().unwrap().to_owned()
}

fn spec(case: &str, method: &str, contact: Option<&str>, raised_mm: f64) -> Value {
    let mut spec = json!({"kind": "predict", "method": method, "case": case, "estimate": "none",
        "plan": {"segments": [{"name": "jaw", "translation_mm": [0, 0, raised_mm]}]},
        "outputs": ["skin.vtp", "volume.vtu"]});
    if let Some(contact) = contact {
        spec["contact"] = json!(contact);
    }
    spec
}

fn has_warning(job: &Value, code: &str) -> bool {
    let warnings = job["results"]["warnings"].as_array().unwrap();
    warnings.iter().any(|warning| warning["code"] == code)
}

#[tokio::test]
async fn contact_is_answered_as_it_is_asked_for_and_reported_with_its_pairs_and_arrays() {
    let server = Server::start();
    let case = case(&server).await;
    let solved = async |contact: Option<&str>, raised_mm: f64| {
        let job = server.job(&spec(&case, "fem_linear", contact, raised_mm)).await;
        let job = job.expect(StatusCode::OK);
        assert_eq!(job["status"], "successful", "{job}");
        job
    };
    for contact in [None, Some("none"), Some("sliding")] {
        let job = solved(contact, 3.0).await;
        assert!(job["results"]["contact"].is_null(), "{job}");
        assert!(has_warning(&job, "skin-overlaps"), "{contact:?}: {job}");
    }
    for contact in ["unilateral", "auto"] {
        let job = solved(Some(contact), 3.0).await;
        let told = &job["results"]["contact"];
        let [pair] = &told["pairs"].as_array().unwrap()[..] else { panic!("{told}") };
        assert!(pair["force_millinewton"].as_f64().unwrap() > 0.0, "{told}");
        // Points do not pass; edges of curved lips do between them, a little.
        assert!(told["largest_penetration_mm"].as_f64().unwrap() < 0.1, "{told}");
        assert_eq!(has_warning(&job, "contact-closed"), contact == "auto", "{job}");
        for (file, arrays) in [
            ("skin.vtp", ["contact_pressure_kpa", "contact_gap_mm"]),
            ("volume.vtu", ["contact_pressure_kpa", "contact_gap_mm"]),
        ] {
            let path = format!("/v1/jobs/{}/results/{file}", job["id"].as_str().unwrap());
            let bytes = ask(server.get(&path)).await.bytes;
            let head = String::from_utf8_lossy(&bytes);
            for array in arrays {
                assert!(head.contains(&format!("Name=\"{array}\"")), "{array} in {file}");
            }
        }
    }
    // Nothing touches: nothing is told, and the answer is that without contact.
    let apart = solved(Some("auto"), 0.5).await;
    assert!(apart["results"]["contact"].is_null() && !has_warning(&apart, "contact-closed"));
    let without = solved(None, 0.5).await;
    assert_eq!(apart["results"]["statistics"], without["results"]["statistics"]);
}

#[tokio::test]
async fn methods_that_know_no_contact_refuse_it() {
    let server = Server::start();
    let case = case(&server).await;
    let refused = server.job(&spec(&case, "msm", Some("unilateral"), 3.0)).await;
    let told = refused.problem(422, "method-not-available");
    // The model of springs is made of tetrahedra too, which is told first.
    let pointers = told["errors"].as_array().unwrap().iter().map(|error| &error["pointer"]);
    assert_eq!(pointers.collect::<Vec<_>>(), [&json!("/case/volume"), &json!("/contact")]);
}
