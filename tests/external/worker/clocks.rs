//! Clocks of hosts that jump. What counts is the clock of the database.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::deployments::Deployment;
use crate::helpers::{SMALL, Server, ask, serve_shared, spec};
use crate::invariants::{accepted, state, tagged};
use crate::processes::{signal, stopped_slot, until};
use crate::support::external::{Missing, REQUIRE_SERVERS};
use crate::support::trials::trials;
use crate::workers::Worker;

trials! {
    alone {
        clocks_that_jump_cost_no_job_an_attempt
    }
}

/// The clock of one process, by libfaketime. The clock that only ever goes on is left alone, as by a system whose time is set.
struct Clock {
    offset: PathBuf,
}

impl Clock {
    fn of(command: &mut Command, library: &Path, offset: PathBuf) -> Clock {
        let clock = Clock { offset };
        clock.jump("+0");
        command.env("LD_PRELOAD", library).env("FAKETIME_TIMESTAMP_FILE", &clock.offset);
        command.env("FAKETIME_NO_CACHE", "1").env("FAKETIME_DONT_FAKE_MONOTONIC", "1");
        clock
    }

    fn jump(&self, offset: &str) {
        let written = self.offset.with_extension("new");
        std::fs::write(&written, offset).unwrap();
        std::fs::rename(written, &self.offset).unwrap();
    }
}

fn library() -> Result<PathBuf, Missing> {
    let folders = std::fs::read_dir("/usr/lib").into_iter().flatten().flatten();
    let mut places = folders.map(|folder| folder.path().join("faketime/libfaketimeMT.so.1"));
    let why = "there is no libfaketime here".to_owned();
    let missing = Missing { why, required_by: Some(REQUIRE_SERVERS) };
    places.find(|place| place.exists()).ok_or(missing)
}

/// The year that a server tells; it goes on telling the latest that it has seen.
async fn year(server: &Server) -> u32 {
    let answer = ask(server.get("/healthz")).await;
    answer.header("date").split(' ').nth(3).unwrap().parse().unwrap()
}

fn ended_in_one_attempt(job: &Value) {
    assert_eq!((&job["status"], &job["attempt"]), (&json!("successful"), &json!(1)), "{job}");
    let times = ["created", "started", "finished"].map(|name| job[name].as_str().unwrap());
    assert!(times.is_sorted(), "{times:?}");
}

async fn clocks_that_jump_cost_no_job_an_attempt() -> Result<(), Missing> {
    let library = library()?;
    let on = Deployment::shared().await?;
    // S3 refuses requests of other times.
    let blobs = on.folder().join("blobs");
    let mut command = serve_shared(&on);
    command.args(["--workers", "0", "--blobs"]).arg(&blobs);
    let of_api = Clock::of(&mut command, &library, on.folder().join("api"));
    let api = Server::start_command(command, TempDir::new().unwrap());
    let mut command = Worker::command(&on);
    command.arg("--blobs").arg(&blobs);
    let of_worker = Clock::of(&mut command, &library, on.folder().join("worker"));
    command.env("FACIES_FAULT", "solve:begin:1:stop:tag=slow");
    let (jumping, _) = Worker::start_command(command);

    let case = api.case(&SMALL).await;
    let id = accepted(&api, &tagged(&case, 1.0, "slow")).await;
    let slot = stopped_slot(jumping.process()).await;
    // Another worker, whose clock is right, would take what it finds without a sign of life.
    let mut command = Worker::command(&on);
    command.arg("--blobs").arg(&blobs);
    let _right = Worker::start_command(command);
    let now = year(&api).await;
    for (number, offset) in ["+3650d", "+0", "-1h"].into_iter().enumerate() {
        of_worker.jump(offset);
        of_api.jump(offset);
        // Longer than a lease: a sign of life comes each 0.2 s at the most.
        for _ in 0..26 {
            let before = state(&api, &id).await["updated"].clone();
            until("there is a sign of life", async || {
                (state(&api, &id).await["updated"] != before).then_some(())
            })
            .await;
        }
        let other = accepted(&api, &spec(&case, 2.0 + number as f64)).await;
        ended_in_one_attempt(&api.ended(&other).await);
        assert!(offset != "+3650d" || year(&api).await > now, "the clock of the API has jumped");
    }
    signal(slot, "CONT");
    ended_in_one_attempt(&api.ended(&id).await);
    Ok(())
}
