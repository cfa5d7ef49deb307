//! Processes that die: that of a slot, that of the worker, again and again.

use std::process::Command;

use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::helpers::{SMALL, Server, ask, serve, spec};
use crate::invariants::{
    MEDIUM, accepted, fails, files, shows_no_result, state, succeeds, tagged, undisturbed, works_on,
};
use crate::processes::{descriptors, faulty, faulty_with_log, is_gone, slots, until};
use crate::samples::ball_ct;

#[tokio::test]
async fn a_slot_that_is_killed_in_the_middle_of_a_solution_costs_one_attempt() {
    let server = faulty("solve:iteration:3:kill:attempt=1", &["--workers", "1"]);
    let before = slots(&server);
    let case = server.case(&MEDIUM).await;
    let id = accepted(&server, &spec(&case, 2.0)).await;
    let job = succeeds(&server, &id, 2).await;
    assert_eq!(files(&job), undisturbed(&MEDIUM, 2.0).await);
    assert_ne!(slots(&server), before, "another process computed the second attempt");
}

#[tokio::test]
async fn a_worker_that_is_killed_in_the_middle_of_a_solution_is_followed_by_the_next() {
    let server = faulty("solve:iteration:3:hold", &["--workers", "1"]);
    let case = server.case(&MEDIUM).await;
    let id = accepted(&server, &spec(&case, 2.0)).await;
    until("the solver iterates", async || {
        (state(&server, &id).await["phase"] == "solve").then_some(())
    })
    .await;
    shows_no_result(&server, &id).await;
    let orphans = slots(&server);
    assert_eq!(orphans.len(), 1);
    let folder = server.kill();
    until("the slot follows its worker", async || is_gone(orphans[0]).then_some(())).await;

    let server = Server::start_in(folder, &[]);
    let job = succeeds(&server, &id, 2).await;
    assert_eq!(files(&job), undisturbed(&MEDIUM, 2.0).await);
    assert_eq!(std::fs::read_dir(server.path().join("tmp")).unwrap().count(), 0);
}

#[tokio::test]
async fn a_training_that_dies_in_its_middle_is_learned_again_to_the_last_digit() {
    let spec = json!({"kind": "learn", "virtual": {"patients": 4, "seed": 3, "fineness": 1}});
    let alone = Server::start();
    let id = accepted(&alone, &spec).await;
    let expected = files(&succeeds(&alone, &id, 1).await);

    // Its process dies once the cohort is gathered, and the next one learns.
    let server = faulty("compare:begin:1:kill:attempt=1", &["--workers", "1"]);
    let id = accepted(&server, &spec).await;
    assert_eq!(files(&succeeds(&server, &id, 2).await), expected);

    // The whole service dies, and the next one learns.
    let server = faulty("compare:begin:1:hold", &["--workers", "1"]);
    let id = accepted(&server, &spec).await;
    until("it learns", async || (state(&server, &id).await["phase"] == "compare").then_some(()))
        .await;
    shows_no_result(&server, &id).await;
    let server = Server::start_in(server.kill(), &[]);
    assert_eq!(files(&succeeds(&server, &id, 2).await), expected);
}

#[tokio::test]
async fn a_service_that_is_killed_while_it_meshes_loses_neither_the_case_nor_what_waits_for_it() {
    for fault in ["mesh:begin:1:hold", "publish:before:1:kill", "publish:after:1:kill"] {
        let server = faulty(fault, &["--workers", "1"]);
        let meshing = json!({"kind": "mesh", "scan": "ct", "thresholds_hu": {"skin": -480, "bone": 620},
            "size": {"tetrahedra": 5000},
            "osteotomy": {
                "cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
                "segments": [{"name": "jaw", "below": ["middle"]}]}});
        let form = Form::new()
            .part("case", Part::text(json!({ "meshing": meshing, "tags": ["ball"] }).to_string()))
            .part("ct", Part::bytes(ball_ct()));
        let case = ask(server.post("/v1/cases").multipart(form)).await.expect(StatusCode::CREATED);
        let (case, meshing) =
            (case["id"].clone(), case["meshing"]["job"].as_str().unwrap().to_owned());
        let asked = json!({"kind": "predict", "case": case, "plan": {"loads": [{"gravity_m_per_s2": [0, 0, -9]}]}});
        let posted = post_job(&server, &asked).await;
        let folder = if fault.ends_with("hold") {
            until("it meshes", async || {
                (state(&server, &meshing).await["phase"] == "mesh").then_some(())
            })
            .await;
            server.kill()
        } else {
            server.dies()
        };
        let server = Server::start_in(folder, &[]);
        let address = format!("/v1/cases/{}", case.as_str().unwrap());
        let view = until("the case has its mesh", async || {
            let view = ask(server.get(&address).header("prefer", "wait=9")).await.json();
            assert_ne!(view["state"], "failed", "{fault}: {view}");
            (view["state"] == "ready").then_some(view)
        })
        .await;
        assert_eq!(view["version"], 2, "{fault}: completed once");
        let attempts = state(&server, &meshing).await["attempt"].clone();
        assert_eq!(attempts, if fault.starts_with("publish:after") { 1 } else { 2 }, "{fault}");
        if let Some(posted) = posted {
            assert_eq!(server.ended(&posted).await["status"], "successful", "{fault}");
        }
    }
}

#[tokio::test]
async fn a_worker_that_dies_before_or_after_it_publishes_publishes_once() {
    for (fault, attempt) in [("publish:before:1:kill", 2), ("publish:after:1:kill", 1)] {
        let server = faulty(fault, &["--workers", "1"]);
        let case = server.case(&SMALL).await;
        let posted = post_job(&server, &spec(&case, 1.0)).await;
        let folder = server.dies();
        let server = Server::start_in(folder, &[]);
        let jobs = ask(server.get("/v1/jobs")).await.json();
        let id = jobs["items"][0]["id"].as_str().unwrap().to_owned();
        assert!(posted.is_none_or(|posted| posted == id), "{fault}");
        let job = succeeds(&server, &id, attempt).await;
        assert_eq!(files(&job), undisturbed(&SMALL, 1.0).await, "{fault}");
        assert_eq!(std::fs::read_dir(server.path().join("tmp")).unwrap().count(), 0, "{fault}");
    }
}

/// The id of a job, unless the server died before it could tell.
async fn post_job(server: &Server, spec: &Value) -> Option<String> {
    let answer = server.post("/v1/jobs").json(spec).send().await.ok()?;
    let job: Value = answer.json().await.ok()?;
    job["id"].as_str().map(str::to_owned)
}

#[tokio::test]
async fn a_job_that_takes_all_memory_fails_with_the_numbers_and_nothing_else_does() {
    let arguments = ["--workers", "1", "--slot-memory-mib", "200"];
    let server = faulty("solve:begin:1:allocate:tag=poison", &arguments);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&case, 1.0, "poison")).await;
    let error = fails(&server, &id, 1).await;
    assert_eq!((&error["type"], &error["class"]), (&"out-of-memory".into(), &"budget".into()));
    assert_eq!(error["limit_mb"], 209.7152);
    let asked = error["asked_mb"].as_f64().unwrap();
    assert!((16.0..17.0).contains(&asked), "{error}");
    works_on(&server).await;
}

#[tokio::test]
async fn a_job_that_kills_its_slot_every_time_fails_and_the_others_go_on() {
    for (fault, how) in [
        ("solve:begin:1:overflow:tag=poison", "its stack was full"),
        ("solve:begin:1:abort:tag=poison", "signal 6 ended it"),
        ("solve:begin:1:kill:tag=poison", "signal 9 ended it"),
    ] {
        let server = faulty(fault, &["--workers", "2"]);
        let case = server.case(&SMALL).await;
        let poison = accepted(&server, &tagged(&case, 1.0, "poison")).await;
        let mut others = Vec::new();
        for x in [2.0, 3.0, 4.0] {
            others.push(accepted(&server, &spec(&case, x)).await);
        }
        let error = fails(&server, &poison, 3).await;
        assert_eq!((&error["type"], &error["attempts"]), (&"worker-lost".into(), &3.into()));
        assert!(error["detail"].as_str().unwrap().contains(how), "{error}");
        for other in others {
            succeeds(&server, &other, 1).await;
        }
        works_on(&server).await;
    }
}

#[tokio::test]
async fn a_panic_in_the_solver_fails_its_job_and_costs_no_slot() {
    let server = faulty("solve:begin:1:panic:tag=poison", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&case, 1.0, "poison")).await;
    let error = fails(&server, &id, 1).await;
    assert_eq!(error["type"], "internal");
    assert!(!error.to_string().contains("fail point"), "what it was is for the log");
    works_on(&server).await;
}

#[tokio::test]
async fn slots_that_do_not_start_take_no_job_and_are_tried_again() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let server = faulty_with_log("slot:start:1:abort", &["--workers", "1"], &log);
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &spec(&case, 1.0)).await;
    let text = until("the slot is tried four times", async || {
        let text = std::fs::read_to_string(&log).unwrap();
        (text.matches("the process of a slot did not start").count() >= 4).then_some(text)
    })
    .await;
    assert!(text.contains("signal 6 ended it"));
    let job = state(&server, &id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&"accepted".into(), &0.into()));
}

#[test]
fn a_fail_point_that_cannot_be_read_stops_the_start() {
    let folder = TempDir::new().unwrap();
    let mut command: Command = serve(folder.path());
    command.env("FACIES_FAULT", "solve:nowhere:1:kill").stderr(std::process::Stdio::piped());
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(78));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.lines().count() == 1 && text.contains("solve:nowhere"), "{text}");
}

#[test]
fn a_slot_without_a_worker_says_what_it_is_and_ends() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    let output = command.arg("slot").stdin(std::process::Stdio::null()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("facies serve"));
}

#[tokio::test]
async fn a_slot_knows_neither_the_database_nor_a_key() {
    const KEY: &str = "0123456789abcdef";
    let folder = TempDir::new().unwrap();
    let mut command = serve(folder.path());
    command.env("FACIES_API_KEY", KEY);
    let data = folder.path().to_str().unwrap().to_owned();
    let server = Server::start_command(command, folder);
    let slots = until("both slots are there", async || {
        // Between fork and exec one is still a copy of its worker.
        let begun = |slot: &u32| {
            let line = std::fs::read_to_string(format!("/proc/{slot}/cmdline"));
            line.is_ok_and(|line| line.starts_with("facies\0slot"))
        };
        let slots: Vec<u32> = slots(&server).into_iter().filter(begun).collect();
        (slots.len() == 2).then_some(slots)
    })
    .await;
    for slot in slots {
        for file in ["environ", "cmdline"] {
            let bytes = std::fs::read(format!("/proc/{slot}/{file}")).unwrap();
            let text = String::from_utf8_lossy(&bytes);
            assert!(!text.contains(KEY), "{text}");
        }
        // Sockets of other programs are none of its; the pair that signals come through is its own.
        let connected = ["tcp", "tcp6"].map(|kind| format!("/proc/{slot}/net/{kind}"));
        let connected = connected.map(|list| std::fs::read_to_string(list).unwrap()).join("");
        for file in descriptors(slot) {
            let inode = file.trim_start_matches("socket:[").trim_end_matches(']');
            let is_connection =
                file.starts_with("socket:") && connected.contains(&format!(" {inode} "));
            assert!(!file.contains(&data) && !is_connection, "{file}");
        }
    }
}
