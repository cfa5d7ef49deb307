//! A disk that errs while a blob is written: nothing half written is ever kept, and nothing that was accepted is lost.

use std::path::PathBuf;
use std::process::Command;

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{SMALL, Server, ask, serve, spec};
use crate::invariants::{accepted, fails, state, succeeds};
use crate::processes::until;
use crate::support::external::{Missing, REQUIRE_SERVERS};
use crate::support::trials::trials;

trials! {
    alone {
        a_mesh_that_the_disk_does_not_take_is_refused_and_no_part_of_it_is_kept
        an_attempt_whose_results_the_disk_does_not_take_is_tried_again
    }
}

/// What a server is started on so that its disk can be told to err.
struct BrokenDisk {
    folder: TempDir,
    library: PathBuf,
}

impl BrokenDisk {
    fn new() -> Result<BrokenDisk, Missing> {
        let folder = TempDir::new().unwrap();
        let library = folder.path().join("broken_disk.so");
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/external/faults/broken_disk.c");
        let made =
            Command::new("cc").args(["-shared", "-fPIC", source, "-o"]).arg(&library).status();
        if made.is_ok_and(|status| status.success()) {
            return Ok(BrokenDisk { folder, library });
        }
        let why = "there is no C compiler here".to_owned();
        Err(Missing { why, required_by: Some(REQUIRE_SERVERS) })
    }

    fn serve(&self, arguments: &[&str]) -> Server {
        let folder = TempDir::new().unwrap();
        let mut command = serve(folder.path());
        command.args(arguments).env("LD_PRELOAD", &self.library).env("BROKEN_DISK", self.orders());
        Server::start_command(command, folder)
    }

    fn orders(&self) -> PathBuf {
        self.folder.path().join("orders")
    }

    fn errs(&self, how: &str) {
        std::fs::write(self.orders(), how).unwrap();
    }

    fn is_mended(&self) {
        std::fs::remove_file(self.orders()).unwrap();
    }
}

/// The files in the folders of the blobs.
fn blobs(server: &Server) -> usize {
    let folders = std::fs::read_dir(server.path().join("blobs")).unwrap();
    folders.map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap().count()).sum()
}

async fn a_mesh_that_the_disk_does_not_take_is_refused_and_no_part_of_it_is_kept()
-> Result<(), Missing> {
    let disk = BrokenDisk::new()?;
    let server = disk.serve(&["--workers", "0"]);
    for how in ["write", "short", "fsync"] {
        disk.errs(how);
        let refused = server.upload(SMALL.vtu()).await;
        refused.problem_of(how, 503, "not-ready");
        assert!(!refused.header("retry-after").is_empty(), "{how}");
        assert_eq!(blobs(&server), 0, "{how}");
    }
    disk.is_mended();
    // Were there a row, it would be told as known.
    server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    Ok(())
}

async fn an_attempt_whose_results_the_disk_does_not_take_is_tried_again() -> Result<(), Missing> {
    let disk = BrokenDisk::new()?;
    let server = disk.serve(&["--workers", "1", "--attempts", "2"]);
    let case = server.case(&SMALL).await;
    let before = blobs(&server);
    disk.errs("fsync");
    let id = accepted(&server, &spec(&case, 1.0)).await;
    until("the first attempt is given up", async || {
        let state = state(&server, &id).await;
        (state["attempt"] == 1 && state["status"] == "accepted").then_some(())
    })
    .await;
    disk.is_mended();
    succeeds(&server, &id, 2).await;

    disk.errs("short");
    let kept = blobs(&server);
    assert!(kept > before);
    let id = accepted(&server, &spec(&case, 2.0)).await;
    let error = fails(&server, &id, 2).await;
    assert_eq!((&error["type"], &error["class"]), (&"storage".into(), &"infrastructure".into()));
    assert_eq!(blobs(&server), kept);
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);
    Ok(())
}
