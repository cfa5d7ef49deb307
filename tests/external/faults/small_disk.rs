//! A disk that is full.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::Command;

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{Block, SMALL, Server, ask, serve, spec};
use crate::invariants::{accepted, state, succeeds, works_on};
use crate::processes::until;
use crate::support::external::Missing;
use crate::support::trials::trials;

trials! {
    alone {
        a_full_disk_refuses_uploads_and_serves_what_is_there
        on_a_disk_without_a_byte_left_uploads_are_refused_and_things_are_erased
        a_service_starts_on_a_disk_without_a_byte_left
        accepted_jobs_wait_on_a_full_disk_with_all_their_attempts
        one_erasure_after_the_other_finds_room_on_a_disk_that_is_filled_again_and_again
    }
}

/// A disk of 24 MiB, where this user may mount one.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount() -> Result<SmallDisk, Missing> {
        let folder = TempDir::new().unwrap();
        let options = ["-t", "tmpfs", "-o", "size=24m", "tmpfs"];
        let mounted = Command::new("mount").args(options).arg(folder.path()).output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Ok(SmallDisk(folder));
        }
        let why = "a small disk can be mounted by root only".to_owned();
        Err(Missing { why, required_by: None })
    }
}

impl SmallDisk {
    fn free(&self) -> usize {
        let disk = rustix::fs::statvfs(self.0.path()).unwrap();
        (disk.f_bavail * disk.f_frsize) as usize
    }

    fn filler(&self) -> PathBuf {
        self.0.path().join("filler")
    }

    fn fill_but(&self, bytes: usize) {
        let filler = vec![0; self.free().saturating_sub(bytes)];
        let file = std::fs::OpenOptions::new().create(true).append(true).open(self.filler());
        file.unwrap().write_all(&filler).unwrap();
    }

    fn empty(&self) {
        std::fs::remove_file(self.filler()).unwrap();
    }

    fn serve(&self) -> Server {
        Server::start_command(serve(&self.0.path().join("data")), TempDir::new().unwrap())
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // A failure leaves an empty mount behind, which no other test meets.
        let _ = Command::new("umount").arg("--lazy").arg(self.0.path()).status();
    }
}

async fn a_full_disk_refuses_uploads_and_serves_what_is_there() -> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let data = disk.0.path().join("data");
    let server = Server::start_command(serve(&data), TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    let kept = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let kept = format!("/v1/jobs/{}", kept["id"].as_str().unwrap());

    // Leaves room for a row and not for a mesh or a result.
    disk.fill_but(100 << 10);
    let large = Block { cells: [40, 40, 10] };
    let answer = server.upload(large.vtu()).await;
    answer.problem(507, "storage-full");
    let blobs = |folder: &str| std::fs::read_dir(data.join(folder)).unwrap().count();
    let before = blobs("blobs");
    ask(server.get(&format!("{kept}/results/skin.vtp"))).await;
    assert_eq!(ask(server.get(&kept)).await.expect(StatusCode::OK)["status"], "successful");
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);

    disk.empty();
    assert_eq!(blobs("blobs"), before);
    let again = server.upload(Block { cells: [6, 6, 6] }.vtu()).await;
    again.expect(StatusCode::CREATED);
    Ok(())
}

async fn on_a_disk_without_a_byte_left_uploads_are_refused_and_things_are_erased()
-> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let server = disk.serve();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    disk.fill_but(0);
    assert_eq!(disk.free(), 0);
    let upload = async || server.upload(Block { cells: [5, 5, 5] }.vtu()).await;
    for _ in 0..4 {
        upload().await.problem(507, "storage-full");
    }
    let job = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    assert_eq!(ask(server.delete(&job)).await.status, StatusCode::NO_CONTENT);
    // It is for what is erased, and not for the next upload.
    upload().await.problem(507, "storage-full");
    let erase = server.delete(&format!("/v1/cases/{case}")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    ask(server.get(&job)).await.problem(410, "gone");
    disk.empty();
    upload().await.expect(StatusCode::CREATED);
    works_on(&server).await;
    Ok(())
}

async fn a_service_starts_on_a_disk_without_a_byte_left() -> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let mut server = disk.serve();
    let case = server.case(&SMALL).await;
    disk.fill_but(0);
    let stops: [fn(Server) -> TempDir; 2] = [Server::kill, |server| server.terminate().0];
    for stop in stops {
        drop(stop(server));
        server = disk.serve();
        let case = format!("/v1/cases/{case}");
        ask(server.get(&case)).await.expect(StatusCode::OK);
    }
    let erase = server.delete(&format!("/v1/cases/{case}")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    Ok(())
}

async fn accepted_jobs_wait_on_a_full_disk_with_all_their_attempts() -> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let log = disk.0.path().join("log");
    let mut command = serve(&disk.0.path().join("data"));
    command.stderr(std::fs::File::create(&log).unwrap());
    let server = Server::start_command(command, TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    // Leaves room for the rows of the jobs, and less than is kept for rows.
    disk.fill_but(512 << 10);
    ask(server.get("/readyz")).await.problem(503, "not-ready");
    let mut jobs = Vec::new();
    for x in 0..4 {
        jobs.push(accepted(&server, &spec(&case, f64::from(x))).await);
    }
    until("the worker tells it", async || {
        let text = std::fs::read_to_string(&log).unwrap();
        text.contains("no job is claimed while the storage fails").then_some(())
    })
    .await;
    for id in &jobs {
        let job = state(&server, id).await;
        assert_eq!((&job["status"], &job["attempt"]), (&"accepted".into(), &0.into()));
    }
    disk.empty();
    for id in &jobs {
        succeeds(&server, id, 1).await;
    }
    Ok(())
}

async fn one_erasure_after_the_other_finds_room_on_a_disk_that_is_filled_again_and_again()
-> Result<(), Missing> {
    let disk = SmallDisk::mount()?;
    let server = disk.serve();
    let case = server.case(&SMALL).await;
    let mut jobs = Vec::new();
    for x in 0..4 {
        let job = server.job(&spec(&case, f64::from(x))).await.expect(StatusCode::OK);
        jobs.push(format!("/v1/jobs/{}", job["id"].as_str().unwrap()));
    }
    for job in &jobs {
        disk.fill_but(0);
        let erased = ask(server.delete(job)).await;
        assert_eq!(erased.status, StatusCode::NO_CONTENT, "{}", disk.free());
        let ready = ask(server.get("/readyz")).await.problem(503, "not-ready");
        assert!(ready["checks"].as_array().unwrap().contains(&"free-space".into()));
    }
    disk.fill_but(0);
    let erase = server.delete(&format!("/v1/cases/{case}")).header("if-match", "*");
    assert_eq!(ask(erase).await.status, StatusCode::NO_CONTENT);
    disk.empty();
    works_on(&server).await;
    Ok(())
}
