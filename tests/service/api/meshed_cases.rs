//! Cases that are posted with a scan: meshed by a job, for which others wait.

use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};
use crate::processes::faulty;
use crate::samples::{BONE_BALL, SKIN_BALL, ball_ct, ball_stl};

/// The lower half of the bone comes loose; cells as coarse as a small test needs.
fn document() -> Value {
    json!({
        "name": "ball", "tags": ["of a scan"],
        "meshing": {
            "kind": "mesh", "scan": "ct", "thresholds_hu": {"skin": -480, "bone": 620},
            "osteotomy": {
                "cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
                "segments": [{"name": "jaw", "below": ["middle"]}],
            },
            "size": {"tetrahedra": 10_000}, "tags": ["meshing"],
        },
        "materials": {"*": {"young_modulus_kpa": 12, "poisson_ratio": 0.45}},
    })
}

async fn post(server: &Server, document: &Value) -> Answer {
    let form = Form::new().part("case", Part::text(document.to_string()));
    let form = form.part("ct", Part::bytes(ball_ct()));
    ask(server.post("/v1/cases").multipart(form)).await
}

fn id(made: &Value) -> String {
    made["id"].as_str().unwrap().to_owned()
}

fn plan_on(case: &Value) -> Value {
    json!({"kind": "predict", "case": case["id"],
        "plan": {"segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}]}})
}

/// The case once its meshing has ended.
async fn settled(server: &Server, case: &str) -> Answer {
    loop {
        let request = server.get(&format!("/v1/cases/{case}")).header("prefer", "wait=30");
        let answer = ask(request).await;
        if answer.expect(StatusCode::OK)["state"] != "meshing" {
            return answer;
        }
    }
}

#[tokio::test]
async fn a_plan_that_is_posted_while_its_case_is_meshed_is_predicted_once_it_has_its_mesh() {
    let server = Server::start();
    let posted = post(&server, &document()).await;
    let case = posted.expect(StatusCode::CREATED);
    assert_eq!(posted.header("location"), format!("/v1/cases/{}", id(&case)));
    assert_eq!(case["state"], "meshing", "{case}");
    assert_eq!(case["case"]["meshing"]["scan"], case["meshes"][0]["id"]);
    assert_eq!(case["case"]["meshing"].get("tags"), None, "they are those of the job");
    assert_eq!(posted.header("etag"), "\"1-meshing\"");
    let meshing = case["meshing"]["job"].as_str().unwrap();
    assert_eq!(case["meshing"]["link"]["href"], format!("/v1/jobs/{meshing}"));
    let predicted = ask(server.post("/v1/jobs").json(&plan_on(&case))).await;
    let predicted = predicted.expect(StatusCode::CREATED);
    let response = json!({"kind": "response", "case": case["id"]});
    let response = ask(server.post("/v1/jobs").json(&response)).await.expect(StatusCode::CREATED);

    let predicted = server.ended(&id(&predicted)).await;
    assert_eq!(predicted["status"], "successful", "{predicted}");
    let progress = ["phase", "iteration", "residual"].map(|name| &predicted[name]);
    assert_eq!(progress, [&Value::Null; 3], "a job that has ended is nowhere any more");
    let largest = predicted["results"]["statistics"]["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!((2.0..4.0).contains(&largest), "{largest}");

    let ready = settled(&server, &id(&case)).await;
    let (tag, ready) = (ready.header("etag").to_owned(), ready.json());
    assert_eq!(
        (&ready["state"], &ready["version"], tag.as_str()),
        (&json!("ready"), &json!(2), "\"2\"")
    );
    let made = server.ended(meshing).await;
    assert_eq!((&made["case"], &made["tags"]), (&case["id"], &json!(["meshing"])));
    assert_eq!(ready["case"]["volume"], made["results"]["kept"][0]["mesh"]);
    assert_eq!(ready["case"]["materials"]["*"]["young_modulus_kpa"].as_f64(), Some(12.0));
    assert_eq!(
        (&ready["case"]["name"], &ready["case"]["tags"]),
        (&json!("ball"), &json!(["of a scan"]))
    );
    assert!(ready["check"]["classes"]["joined"]["jaw"].as_u64().unwrap() > 10, "{ready}");
    let listed = ask(server.get("/v1/cases?tag=of%20a%20scan")).await.json();
    assert_eq!(listed["items"][0]["state"], "ready");

    // What the meshing had to say stands on the case and on every answer on it.
    let told = made["results"]["warnings"].as_array().unwrap();
    assert!(told.iter().any(|warning| warning["code"] == "no-landmarks"), "{told:?}");
    for (of, said) in
        [("case", &ready["check"]["warnings"]), ("prediction", &predicted["results"]["warnings"])]
    {
        let said = said.as_array().unwrap();
        assert!(told.iter().all(|warning| said.contains(warning)), "{of}: {said:?}, not {told:?}");
    }

    // The same plan is the same job, although that was accepted before there was a mesh to tell it by.
    let again = ask(server.post("/v1/jobs").json(&plan_on(&case))).await.expect(StatusCode::OK);
    assert_eq!((&again["id"], &again["deduplicated"]), (&predicted["id"], &json!(true)));
    // And the response answers for the case.
    assert_eq!(server.ended(&id(&response)).await["status"], "successful");
    let address = format!("/v1/cases/{}/response/apply", id(&case));
    let applied = ask(server.post(&address).json(&json!({"plan": plan_on(&case)["plan"]}))).await;
    let applied = applied.expect(StatusCode::OK)["max_mm"].as_f64().unwrap();
    assert!((applied - largest).abs() < 1e-3, "{applied}, {largest}");
}

#[tokio::test]
async fn what_needs_the_mesh_of_a_case_without_one_is_refused_with_the_job_that_makes_it() {
    let server = faulty("mesh:begin:1:hold", &["--workers", "1"]);
    let case = post(&server, &document()).await.expect(StatusCode::CREATED);
    let (case_id, meshing) = (id(&case), case["meshing"]["job"].as_str().unwrap().to_owned());
    server.started(&meshing).await;
    let own = format!("/v1/cases/{case_id}");
    let plan = plan_on(&case)["plan"].clone();
    let refused = |answer: Answer| {
        let problem = answer.problem(409, "case-not-ready");
        assert_eq!(
            (&problem["state"], &problem["job"]),
            (&json!("meshing"), &json!(meshing)),
            "{problem}"
        );
    };
    refused(ask(server.post(&format!("{own}/check"))).await);
    refused(ask(server.get(&format!("{own}/response"))).await);
    refused(ask(server.post(&format!("{own}/response/apply")).json(&json!({"plan": plan}))).await);
    let scenes = json!([{"case": case_id, "plans": [plan]}]);
    let study =
        json!({"kind": "study", "scenes": scenes, "methods": ["fem_linear"], "levels": [0]});
    refused(ask(server.post("/v1/jobs").json(&study)).await);
    let batch = json!({"kind": "batch", "items": [{"case": case_id, "plan": plan}]});
    refused(ask(server.post("/v1/jobs").json(&batch)).await);
    // What needs no mesh is refused at once.
    let mut wrong = plan_on(&case);
    wrong["tolerance"] = json!({"relative_residual": 2});
    let problem = ask(server.post("/v1/jobs").json(&wrong)).await.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/tolerance/relative_residual", "{problem}");

    let jaw = |members: Value| {
        let mut segment = json!({"name": "jaw"});
        segment.as_object_mut().unwrap().extend(members.as_object().unwrap().clone());
        json!({"plan": {"segments": [segment]}})
    };
    let scales = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];
    let pressure = json!({"pressure_kpa": 1e30, "faces": {"node_set": "skin"}});
    for (change, pointer) in [
        (jaw(json!({"translation_mm": [1e9, 1, 1]})), "/plan/segments/0/translation_mm"),
        (
            jaw(json!({"rotation_deg": [170, 0, 0], "pivot_mm": [0, 0, 0]})),
            "/plan/segments/0/rotation_deg",
        ),
        (jaw(json!({"matrix4x4": scales})), "/plan/segments/0/matrix4x4"),
        (
            json!({"plan": {"segments": [plan["segments"][0], plan["segments"][0]]}}),
            "/plan/segments/1/name",
        ),
        (json!({"plan": {"loads": [pressure]}}), "/plan/loads/0/pressure_kpa"),
        (json!({"materials": {"*": {"poisson_ratio": 0.7}}}), "/materials/*/poisson_ratio"),
        (json!({"method": "msm", "element": "quadratic"}), "/element"),
        (json!({"method": "mtm_nonlinear", "element": "quadratic"}), "/element"),
    ] {
        let mut wrong = plan_on(&case);
        wrong.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        let answer = ask(server.post("/v1/jobs").json(&wrong)).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{pointer}: {answer:?}");
        assert_eq!(answer.json()["errors"][0]["pointer"], pointer, "{answer:?}");
    }

    let waits =
        ask(server.post("/v1/jobs").json(&plan_on(&case))).await.expect(StatusCode::CREATED);
    assert_eq!(waits["queue_position"], Value::Null);
    assert!(waits["message"].as_str().unwrap().contains(&meshing), "{waits}");
    let known = ask(server.get(&own).header("if-none-match", "\"1-meshing\"")).await;
    assert_eq!(known.status, StatusCode::NOT_MODIFIED);

    // Who erases the case ends its meshing.
    let deleted = ask(server.delete(&own).header("if-match", "\"1-meshing\"")).await;
    assert_eq!(deleted.status, StatusCode::NO_CONTENT);
    for gone in [&meshing, &id(&waits)] {
        ask(server.get(&format!("/v1/jobs/{gone}"))).await.problem(410, "gone");
    }
    let other = server.case(&SMALL).await;
    let free = ask(server.post("/v1/jobs").json(&spec(&other, 1.0))).await.json();
    assert_eq!(server.ended(&id(&free)).await["status"], "successful", "the slot is free again");
}

#[tokio::test]
async fn a_meshing_that_fails_stands_on_its_case_and_fails_what_waited_with_its_reason() {
    let server = Server::start();
    let mut empty = document();
    empty["meshing"].as_object_mut().unwrap().remove("osteotomy");
    empty["meshing"]["thresholds_hu"] = json!({"skin": 3000, "bone": 4000});
    let case = post(&server, &empty).await.expect(StatusCode::CREATED);
    let waits = ask(server.post("/v1/jobs").json(&plan_on(&case))).await;
    // It may have failed already on a machine with little to do.
    if waits.status == StatusCode::CREATED {
        let failed = server.ended(&id(&waits.json())).await;
        assert_eq!(
            (&failed["status"], &failed["error"]["type"]),
            (&json!("failed"), &json!("case-not-ready"))
        );
        assert!(failed["error"]["detail"].as_str().unwrap().contains("no-tissue"), "{failed}");
    }
    let failed = settled(&server, &id(&case)).await;
    assert_eq!(failed.header("etag"), "\"1-failed\"");
    let failed = failed.json();
    assert_eq!(
        (&failed["state"], &failed["meshing"]["error"]["type"]),
        (&json!("failed"), &json!("no-tissue"))
    );
    let problem = server.job(&plan_on(&case)).await.problem(409, "case-not-ready");
    assert_eq!(problem["error"]["type"], "no-tissue", "{problem}");

    let mut in_air = document();
    in_air["meshing"]["osteotomy"]["segments"][0]["seeds_mm"] = json!([[60, 55, 50], [1, 1, 1]]);
    let case = post(&server, &in_air).await.expect(StatusCode::CREATED);
    let meshing = server.ended(case["meshing"]["job"].as_str().unwrap()).await;
    let told = &meshing["error"]["errors"][0]["pointer"];
    assert_eq!(told, "/meshing/osteotomy/segments/0/seeds_mm/1", "{meshing}");
}

#[tokio::test]
async fn a_meshing_that_the_storage_failed_is_tried_again_when_a_job_is_posted() {
    let server = faulty("publish:before:1:error:attempt=1:tag=meshing", &["--attempts", "1"]);
    let case = post(&server, &document()).await.expect(StatusCode::CREATED);
    let failed = settled(&server, &id(&case)).await.json();
    assert_eq!(
        (&failed["state"], &failed["meshing"]["error"]["type"]),
        (&json!("failed"), &json!("storage"))
    );
    let waits = server.job(&plan_on(&case)).await;
    assert!(waits.status.is_success(), "{}", waits.status);
    assert_eq!(server.ended(&id(&waits.json())).await["status"], "successful");
    let case = settled(&server, &id(&case)).await.json();
    assert_eq!(case["state"], "ready", "{case}");
}

#[tokio::test]
async fn a_case_to_be_meshed_that_makes_no_sense_is_refused_before_it_is_kept() {
    let server = Server::start();
    let refused = async |change: &dyn Fn(&mut Value), code: &str, at: &str| {
        let mut asked = document();
        change(&mut asked);
        let problem = post(&server, &asked).await.problem(422, "validation-failed");
        let told = &problem["errors"][0];
        assert_eq!((&told["code"], &told["pointer"]), (&json!(code), &json!(at)), "{problem}");
    };
    let unknown = |asked: &mut Value| {
        asked["meshing"]["osteotomy"]["segments"][0]["below"] = json!(["nowhere"])
    };
    refused(&unknown, "unknown-cut", "/meshing/osteotomy/segments/0/below/0").await;
    let volume = |asked: &mut Value| asked["volume"] = json!("ct");
    refused(&volume, "unknown-field", "/volume").await;
    let image = |asked: &mut Value| {
        let tissue = json!({"name": "fat", "from_hu": -200, "to_hu": -30,
            "material": {"young_modulus_kpa": 20, "poisson_ratio": 0.45}});
        asked["hounsfield"] =
            json!({"image": "another", "samples": 8, "mixing": "mean", "tissues": [tissue]});
    };
    refused(&image, "unknown-mesh", "/hounsfield/image").await;
    let tags = |asked: &mut Value| asked["tags"] = json!([""]);
    refused(&tags, "bad-name", "/tags/0").await;
    let cases = ask(server.get("/v1/cases")).await.json();
    assert_eq!(cases["items"], json!([]));
}

/// Surfaces without a mark are in the frame of their document, which is that of its places: they are turned together.
#[tokio::test]
async fn surfaces_without_a_mark_are_posted_in_the_frame_of_their_case() {
    let server = Server::start();
    let document = json!({"meshing": {"kind": "mesh", "frame": "RAS",
        "surfaces": {"skin": "skin", "bones": [{"name": "jaw", "mesh": "jaw"}]},
        "size": {"tetrahedra": 5000, "fine": [{"sphere_mm": [60, 55, 60, 60]}]}}});
    let form = Form::new().part("case", Part::text(document.to_string()));
    let form = form.part("skin", Part::bytes(ball_stl(SKIN_BALL)));
    let form = form.part("jaw", Part::bytes(ball_stl(BONE_BALL)));
    let posted = ask(server.post("/v1/cases").multipart(form)).await;
    let case = posted.expect(StatusCode::CREATED);
    let made = settled(&server, &id(&case)).await.json();
    assert_eq!(
        (&made["state"], &made["case"]["frame"]),
        (&json!("ready"), &json!("LPS")),
        "{made}"
    );
    let job = server.ended(case["meshing"]["job"].as_str().unwrap()).await;
    assert!(!job["results"]["warnings"].to_string().contains("fine-place-empty"), "{job}");
    let centre = &job["results"]["meshing"]["segments"][0]["centre_mm"];
    let at = |axis: usize| centre[axis].as_f64().unwrap().round();
    assert_eq!([at(0), at(1), at(2)], [-60.0, -55.0, 60.0], "{job}");
}
