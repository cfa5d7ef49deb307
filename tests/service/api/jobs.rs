//! Jobs: from a request to results, waited for, known again, listed, dismissed, removed.

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask, spec};
use crate::samples::{SKIN_BALL, ball_stl};

#[tokio::test]
async fn a_comparison_of_more_samples_than_can_be_measured_is_refused_when_it_is_posted() {
    let server = Server::start_with(&["--workers", "0"]);
    // A hundred metres wide: 100 samples on each mm2 are 1e12.
    let wide = b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2e5 0 0\nvertex 0 1e5 0\nendloop\nendfacet\nendsolid x\n";
    let wide = server.upload(wide.to_vec()).await.expect(StatusCode::CREATED)["id"].clone();
    let case = server.case(&SMALL).await;
    let mut compare = json!({"kind": "compare", "prediction": {"mesh": wide},
        "actual": {"mesh": wide}, "samples_per_mm2": 100});
    let mut predict = spec(&case, 1.0);
    predict["compare_to"] = json!({"actual": {"mesh": wide}, "samples_per_mm2": 100});
    for (job, at) in [(&compare, "/samples_per_mm2"), (&predict, "/compare_to/samples_per_mm2")] {
        let refused = ask(server.post("/v1/jobs").json(job)).await;
        let problem = refused.problem(422, "validation-failed");
        let error = &problem["errors"][0];
        assert_eq!((&error["code"], &error["pointer"]), (&json!("too-many-samples"), &json!(at)));
        assert!(problem.to_string().contains("1.000e12 samples"), "{problem}");
    }
    compare["samples_per_mm2"] = json!(1e-4);
    ask(server.post("/v1/jobs").json(&compare)).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn two_calls_predict_the_skin_of_a_new_patient() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let answer = server.job(&spec(&case, 2.0)).await;
    let job = answer.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful");
    assert_eq!(answer.header("preference-applied"), "wait=30");
    let id = job["id"].as_str().unwrap();
    assert_eq!(answer.header("content-location"), format!("/v1/jobs/{id}"));
    assert_eq!(job["case"], case);
    assert_eq!((&job["attempt"], &job["progress"]), (&json!(1), &json!(100)));

    let moved = &job["results"]["statistics"];
    let middle = moved["landmarks"]["middle"][0].as_f64().unwrap();
    assert!(middle > 0.0 && middle < 2.0, "{middle}");
    // Nothing of the skin moves farther than the bone does.
    let largest = moved["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!(largest > 0.0 && largest <= 2.0, "{largest}");
    let provenance = &job["results"]["provenance"];
    assert!(provenance["solver"]["relative_residual"].as_f64().unwrap() <= 1e-8);
    assert_eq!(provenance["spec_hash"], job["spec_hash"]);
}

#[tokio::test]
async fn every_file_of_the_manifest_is_served_with_its_hash_and_in_ranges() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut spec = spec(&case, 1.0);
    spec["outputs"] =
        json!(["skin.vtp", "skin.stl", "skin.ply", "skin.glb", "skin.csv", "volume.vtu"]);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    let id = job["id"].as_str().unwrap();
    let manifest = ask(server.get(&format!("/v1/jobs/{id}/results"))).await.expect(StatusCode::OK);
    assert_eq!(manifest["statistics"], job["results"]["statistics"]);
    let files = manifest["files"].as_array().unwrap();
    assert_eq!(files.len(), 6);
    for file in files {
        let name = file["name"].as_str().unwrap();
        let path = format!("/v1/jobs/{id}/results/{name}");
        let answer = ask(server.get(&path)).await;
        assert_eq!(answer.status, StatusCode::OK, "{name}");
        assert_eq!(answer.header("content-type"), file["media_type"].as_str().unwrap());
        assert_eq!(
            facies::schema::wire::canonical::sha256_hex(&answer.bytes),
            file["sha256"].as_str().unwrap()
        );
        assert_eq!(answer.bytes.len() as u64, file["bytes"].as_u64().unwrap());
        let tag = answer.header("etag").to_owned();
        let known = ask(server.get(&path).header("if-none-match", &tag)).await;
        assert_eq!((known.status, known.bytes.len()), (StatusCode::NOT_MODIFIED, 0));
        let part = ask(server.get(&path).header("range", "bytes=5-9")).await;
        assert_eq!(part.status, StatusCode::PARTIAL_CONTENT);
        assert_eq!(part.bytes, answer.bytes[5..=9]);
        for beyond in ["bytes=99999999-", "bytes=-0"] {
            let beyond = ask(server.get(&path).header("range", beyond)).await;
            beyond.problem(416, "range-not-satisfiable");
        }
        let many = format!("bytes={}1-1", "0-0,".repeat(1000));
        let whole = ask(server.get(&path).header("range", many)).await;
        assert_eq!((whole.status, whole.bytes), (StatusCode::OK, answer.bytes));
    }
    let result = ask(server.get(&format!("/v1/jobs/{id}/results/result.json"))).await;
    assert_eq!(result.expect(StatusCode::OK)["statistics"], manifest["statistics"]);
    let missing = ask(server.get(&format!("/v1/jobs/{id}/results/skin.obj"))).await;
    let problem = missing.problem(404, "no-such-output");
    let detail = problem["detail"].as_str().unwrap();
    for said in ["skin.obj", "skin.stl", "classes.svg", "`outputs`"] {
        assert!(detail.contains(said), "{detail}");
    }
    let picture =
        server.get(&format!("/v1/jobs/{id}/results/skin.stl")).header("accept", "image/png");
    ask(picture).await.problem(406, "not-acceptable");
}

#[tokio::test]
async fn the_same_inputs_are_answered_by_the_job_that_is_known() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let first = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    assert_eq!(first["deduplicated"], false);
    let mut again = spec(&case, 1.0);
    again["tags"] = json!(["again"]);
    again["method"] = json!("auto");
    let second = ask(server.post("/v1/jobs").json(&again)).await.expect(StatusCode::OK);
    assert_eq!((&second["id"], &second["deduplicated"]), (&first["id"], &json!(true)));
    assert_eq!(second["tags"], json!(["again"]), "it is found by the tags of everybody who asked");
    let found = ask(server.get("/v1/jobs?tag=again")).await.expect(StatusCode::OK);
    assert_eq!(found["items"][0]["id"], first["id"]);
    let other = server.job(&spec(&case, 1.5)).await.expect(StatusCode::OK);
    assert_ne!(other["id"], first["id"]);

    // One more than it may have: what was put on first goes.
    for number in 0..32 {
        again["tags"] = json!([format!("run {number:02}")]);
        let answer = ask(server.post("/v1/jobs").json(&again)).await.expect(StatusCode::OK);
        assert_eq!(answer["id"], first["id"]);
    }
    again["tags"] = json!(["the newest", "run 07"]);
    let answer = ask(server.post("/v1/jobs").json(&again)).await.expect(StatusCode::OK);
    let mut left: Vec<String> = (1..32).map(|number| format!("run {number:02}")).collect();
    left.push("the newest".to_owned());
    assert_eq!(answer["tags"], json!(left));
    again["tags"] = (0..33).map(|number| format!("t{number}")).collect();
    let refused = ask(server.post("/v1/jobs").json(&again)).await;
    let problem = refused.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["code"], "too-many", "{problem}");
}

#[tokio::test]
async fn tags_of_a_job_are_changed_whatever_its_state() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut spec = spec(&case, 1.0);
    spec["tags"] = json!(["first"]);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let change = |change: Value| {
        let request = server.request(Method::PATCH, &path).json(&change);
        async { ask(request).await }
    };
    let answer = change(json!({"tags": {"add": ["main", "b"], "remove": ["first"]}})).await;
    assert_eq!(answer.expect(StatusCode::OK)["tags"], json!(["b", "main"]));
    let shown = ask(server.get(&path)).await;
    assert_eq!(shown.json()["tags"], json!(["b", "main"]));
    assert_eq!((shown.header("etag"), &shown.bytes), (answer.header("etag"), &answer.bytes));

    let many: Vec<String> = (0..33).map(|number| format!("t{number}")).collect();
    for (wrong, code, at) in [
        (json!({"tags": {"add": many}}), "too-many", "/tags/add"),
        (json!({"tags": {"add": ["x"], "remove": ["x"]}}), "duplicate-name", "/tags/add/0"),
        (json!({"tags": {"set": ["x"]}}), "unknown-field", "/tags/set"),
        (json!({"tags": {"add": [""]}}), "bad-name", "/tags/add/0"),
        (json!({"status": "successful"}), "unknown-field", "/status"),
    ] {
        let problem = change(wrong).await.problem(422, "validation-failed");
        let error = &problem["errors"][0];
        assert_eq!((&error["code"], &error["pointer"]), (&json!(code), &json!(at)));
    }
    // A change that was meant for another state is not made.
    let patch = |tag: &str, state: &str| {
        let change = json!({"tags": {"add": [tag]}});
        ask(server.request(Method::PATCH, &path).header("if-match", state).json(&change))
    };
    let refused = patch("late", "\"0\"").await;
    let state = refused.problem(412, "precondition-failed")["etag"].as_str().unwrap().to_owned();
    assert_eq!(ask(server.get(&path)).await.header("etag"), state);
    assert_eq!(ask(server.get(&path)).await.json()["tags"], json!(["b", "main"]));
    let nobody = "/v1/jobs/00000000-0000-7000-8000-000000000000";
    let request = server.request(Method::PATCH, nobody).json(&json!({"tags": {"add": ["x"]}}));
    ask(request).await.problem(404, "no-such-job");
}

#[tokio::test]
async fn a_job_that_is_not_waited_for_is_accepted_and_found_again() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let answer = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    let job = answer.expect(StatusCode::CREATED);
    let id = job["id"].as_str().unwrap();
    assert_eq!(answer.header("location"), format!("/v1/jobs/{id}"));
    assert!(!answer.header("retry-after").is_empty());
    assert_eq!((&job["status"], &job["queue_position"]), (&json!("accepted"), &json!(0)));
    let results = ask(server.get(&format!("/v1/jobs/{id}/results"))).await;
    let problem = results.problem(404, "result-not-ready");
    assert_eq!(problem["job_status"], "accepted");
    let file = ask(server.get(&format!("/v1/jobs/{id}/results/skin.vtp"))).await;
    file.problem(404, "result-not-ready");

    let dismissed = ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    assert_eq!(dismissed["status"], "dismissed");
    ask(server.get(&format!("/v1/jobs/{id}/results"))).await.problem(422, "job-failed");
    assert_eq!(ask(server.delete(&format!("/v1/jobs/{id}"))).await.status, StatusCode::NO_CONTENT);
    ask(server.get(&format!("/v1/jobs/{id}"))).await.problem(410, "gone");
    ask(server.delete(&format!("/v1/jobs/{id}"))).await.problem(410, "gone");
}

#[tokio::test]
async fn a_dismissed_job_may_be_asked_for_again() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let post = || server.post("/v1/jobs").json(&spec(&case, 1.0));
    let first = ask(post()).await.expect(StatusCode::CREATED);
    let known = ask(post()).await.expect(StatusCode::OK);
    assert_eq!(known["id"], first["id"]);
    let id = first["id"].as_str().unwrap();
    ask(server.delete(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    let anew = ask(post()).await.expect(StatusCode::CREATED);
    assert_ne!(anew["id"], first["id"]);
    assert_eq!(anew["spec_hash"], first["spec_hash"]);
    let before = ask(server.get(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
    assert_eq!(
        (&before["status"], &before["spec_hash"]),
        (&json!("dismissed"), &first["spec_hash"])
    );
}

#[tokio::test]
async fn jobs_are_listed_in_pages_newest_first_and_by_what_they_are() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let mut ids = Vec::new();
    for x in 1..=5 {
        let mut spec = spec(&case, f64::from(x));
        spec["tags"] = json!([if x % 2 == 0 { "even" } else { "odd" }]);
        let job = ask(server.post("/v1/jobs").json(&spec)).await.expect(StatusCode::CREATED);
        ids.insert(0, job["id"].clone());
    }
    let mut listed = Vec::new();
    let mut next = String::new();
    loop {
        let page = ask(server.get(&format!("/v1/jobs?limit=2{next}"))).await.expect(StatusCode::OK);
        listed.extend(page["items"].as_array().unwrap().iter().map(|job| job["id"].clone()));
        match page["next"].as_str() {
            Some(cursor) => next = format!("&cursor={cursor}"),
            None => break,
        }
    }
    assert_eq!(listed, ids);
    for (query, count) in [
        ("tag=even", 2),
        ("status=accepted", 5),
        ("status=running", 0),
        ("kind=predict", 5),
        ("kind=compare", 0),
        (&format!("case={case}"), 5),
    ] {
        let page = ask(server.get(&format!("/v1/jobs?{query}"))).await.expect(StatusCode::OK);
        assert_eq!(page["items"].as_array().unwrap().len(), count, "{query}");
    }
    for query in [
        "cursor=forged",
        "case=none",
        "limit=0",
        "limit=201",
        "limit=x",
        "status=zombie",
        "stauts=failed",
    ] {
        let answer = ask(server.get(&format!("/v1/jobs?{query}"))).await;
        let problem = answer.problem_of(query, 400, "invalid-parameter");
        let parameter = query.split('=').next().unwrap();
        assert_eq!(problem["parameter"], parameter, "{problem}");
        let detail = problem["detail"].as_str().unwrap();
        assert!(parameter != "limit" || detail.contains("1 to 200"), "{problem}");
    }
}

#[tokio::test]
async fn a_prediction_is_compared_with_another_surface() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let id = job["id"].as_str().unwrap();
    let skin = ask(server.get(&format!("/v1/jobs/{id}/results/skin.vtp"))).await;
    let actual = server.upload(skin.bytes).await.expect(StatusCode::CREATED);
    let compare = json!({
        "kind": "compare", "prediction": {"job": id}, "actual": {"mesh": actual["id"]},
    });
    let compared = server.job(&compare).await.expect(StatusCode::OK);
    let both = &compared["results"]["comparison"];
    assert!(both.is_object(), "{compared}");
    let text = both.to_string();
    assert!(text.contains("hausdorff"), "{text}");
    // Comparisons of several subjects make a cohort; what compared nothing does not.
    let cohort = |ids: &Value| json!({"kind": "cohort", "groups": {"a": [ids], "b": [ids]}});
    let held = server.job(&cohort(&compared["id"])).await.expect(StatusCode::OK);
    let group = &held["results"]["cohort"]["groups"][0];
    assert_eq!(group["rows"][0]["distances"]["mean"], both["both"]["mean"], "{held}");
    assert_eq!(held["results"]["cohort"]["pairs"][0]["differing"], 0, "{held}");
    for (wrong, code) in [(&job["id"], "no-such-output"), (&actual["id"], "unknown-job")] {
        let problem = server.job(&cohort(wrong)).await.problem(422, "validation-failed");
        let told = &problem["errors"][0];
        assert_eq!((&told["pointer"], &told["code"]), (&json!("/groups/a/0"), &json!(code)));
    }
    let in_use =
        ask(server.delete(&format!("/v1/meshes/{}", actual["id"].as_str().unwrap()))).await;
    in_use.problem(409, "conflict-in-use");
}

#[tokio::test]
async fn a_comparison_that_fails_names_the_place_in_what_was_posted() {
    let server = Server::start();
    let mut ids = Vec::new();
    for frame in ["LPS", "RAS"] {
        let path = format!("/v1/meshes?units=mm&frame={frame}");
        let request = server.post(&path).header("content-type", "application/octet-stream");
        let mesh = ask(request.body(ball_stl(SKIN_BALL))).await;
        ids.push(mesh.expect(StatusCode::CREATED)["id"].clone());
    }
    let compare =
        json!({"kind": "compare", "prediction": {"mesh": ids[0]}, "actual": {"mesh": ids[1]}});
    let job = server.job(&compare).await.expect(StatusCode::CREATED);
    let error = server.ended(job["id"].as_str().unwrap()).await["error"].clone();
    let told = &error["errors"][0];
    assert_eq!(
        (&told["code"], &told["pointer"]),
        (&json!("frame-conflict"), &json!("/actual/mesh"))
    );
    assert!(error["detail"].as_str().unwrap().starts_with("/actual/mesh: "), "{error}");
}

#[tokio::test]
async fn an_identity_plan_moves_nothing() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 0.0)).await.expect(StatusCode::OK);
    let largest = job["results"]["statistics"]["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!(largest <= 1e-12, "{largest}");
}

#[tokio::test]
async fn a_wait_is_granted_up_to_its_cap_and_reported() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = server.case(&SMALL).await;
    let job =
        ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await.expect(StatusCode::CREATED);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let none = ask(server.get(&path).header("prefer", "wait=-1")).await;
    assert_eq!((none.status, none.header("preference-applied")), (StatusCode::OK, ""));
    let one = ask(server.get(&path).header("prefer", "respond-async, wait=1")).await;
    assert_eq!((one.status, one.header("preference-applied")), (StatusCode::OK, "wait=1"));
    assert_eq!(one.json()["status"], "accepted");
    ask(server.delete(&path)).await.expect(StatusCode::OK);
    let long = ask(server.get(&path).header("prefer", "wait=99999")).await;
    assert_eq!((long.status, long.header("preference-applied")), (StatusCode::OK, "wait=30"));
}
