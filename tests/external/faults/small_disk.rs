//! A disk that is full.

use std::process::Command;

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{Block, SMALL, Server, ask, serve, spec};
use crate::support::external::Missing;
use crate::support::trials::trials;

trials! {
    alone {
        a_full_disk_refuses_uploads_fails_jobs_and_serves_what_is_there
    }
}

/// A disk of a few MiB, where this user may mount one.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount() -> Result<SmallDisk, Missing> {
        let folder = TempDir::new().unwrap();
        let options = ["-t", "tmpfs", "-o", "size=6m", "tmpfs"];
        let mounted = Command::new("mount").args(options).arg(folder.path()).output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Ok(SmallDisk(folder));
        }
        let why = "a small disk can be mounted by root only".to_owned();
        Err(Missing { why, required_by: None })
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // A failure leaves an empty mount behind, which no other test meets.
        let _ = Command::new("umount").arg("--lazy").arg(self.0.path()).status();
    }
}

async fn a_full_disk_refuses_uploads_fails_jobs_and_serves_what_is_there() -> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let data = disk.0.path().join("data");
    let server = Server::start_command(serve(&data), TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    let kept = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let kept = format!("/v1/jobs/{}", kept["id"].as_str().unwrap());

    // Leaves room for a row and not for a mesh or a result.
    let filler = disk.0.path().join("filler");
    let free = || {
        let disk = rustix::fs::statvfs(disk.0.path()).unwrap();
        (disk.f_bavail * disk.f_frsize) as usize
    };
    std::fs::write(&filler, vec![0; free().saturating_sub(100 << 10)]).unwrap();
    let large = Block { cells: [40, 40, 10] };
    let answer = server.upload(large.vtu()).await;
    answer.problem(507, "storage-full");
    let blobs = |folder: &str| std::fs::read_dir(data.join(folder)).unwrap().count();
    let before = blobs("blobs");
    ask(server.get(&format!("{kept}/results/skin.vtp"))).await;
    assert_eq!(ask(server.get(&kept)).await.expect(StatusCode::OK)["status"], "successful");
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);

    std::fs::remove_file(&filler).unwrap();
    assert_eq!(blobs("blobs"), before);
    let again = server.upload(Block { cells: [6, 6, 6] }.vtu()).await;
    again.expect(StatusCode::CREATED);
    Ok(())
}
