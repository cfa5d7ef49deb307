//! What the service stands on fails for a while: its database is slow or locked, it has no descriptors, nobody reads its
//! log, the power goes.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use reqwest::StatusCode;
use sqlx::{Connection as _, SqliteConnection};
use tempfile::TempDir;
use tokio::net::TcpStream;

use crate::helpers::{SMALL, Server, ask, read, serve, spec};
use crate::invariants::{accepted, is_shed, state, succeeds, tagged, works_on};
use crate::processes::{faulty, signal, slots, until};

/// Somebody else at the database of a server, such as a backup.
async fn another(server: &Server) -> SqliteConnection {
    let file = server.path().join("facies.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file);
    SqliteConnection::connect_with(&options).await.unwrap()
}

async fn says(connection: &mut SqliteConnection, sql: &'static str) {
    sqlx::raw_sql(sql).execute(connection).await.unwrap();
}

#[tokio::test]
async fn one_who_reads_the_embedded_database_for_long_keeps_nobody_from_writing() {
    let server = Server::start();
    let mut reader = another(&server).await;
    says(&mut reader, "BEGIN").await;
    let jobs = async |reader: &mut SqliteConnection| -> i64 {
        sqlx::query_scalar("SELECT COUNT(*) FROM jobs").fetch_one(reader).await.unwrap()
    };
    assert_eq!(jobs(&mut reader).await, 0);
    works_on(&server).await;
    assert_eq!(jobs(&mut reader).await, 0, "it read all the time");
}

#[tokio::test]
async fn one_who_writes_to_the_embedded_database_is_waited_for() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut writer = another(&server).await;
    says(&mut writer, "BEGIN IMMEDIATE").await;
    let request = server.post("/v1/jobs").json(&spec(&case, 1.0));
    let posting = tokio::spawn(request.send());
    for _ in 0..5 {
        ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    }
    assert!(!posting.is_finished());
    says(&mut writer, "COMMIT").await;
    let job = read(posting.await.unwrap().unwrap()).await.expect(StatusCode::CREATED);
    succeeds(&server, job["id"].as_str().unwrap(), 1).await;
}

#[tokio::test]
async fn an_embedded_database_that_stays_locked_is_reported_as_503_and_nothing_is_lost() {
    let server = faulty("solve:begin:1:stop:attempt=1:tag=slow", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let running = accepted(&server, &tagged(&case, 1.0, "slow")).await;
    server.started(&running).await;
    let mut writer = another(&server).await;
    says(&mut writer, "BEGIN IMMEDIATE").await;
    let refused = ask(server.post("/v1/jobs").json(&spec(&case, 2.0))).await;
    assert!(is_shed(&refused));
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);
    says(&mut writer, "COMMIT").await;
    slots(&server).into_iter().for_each(|slot| signal(slot, "CONT"));
    let ended = server.ended(&running).await;
    assert_eq!(ended["status"], "successful", "{ended}");
    let again = accepted(&server, &spec(&case, 2.0)).await;
    succeeds(&server, &again, 1).await;
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(jobs["items"].as_array().unwrap().len(), 2);
}

#[tokio::test]
async fn a_server_without_descriptors_left_answers_again_once_its_clients_have_gone() {
    let folder = TempDir::new().unwrap();
    let usual = serve(folder.path());
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -n 64; exec \"$0\" \"$@\""]).arg(usual.get_program());
    command.args(usual.get_args()).stdout(Stdio::piped()).stderr(Stdio::null());
    let server = Server::start_command(command, folder);
    works_on(&server).await;
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    let skin = format!("/v1/jobs/{}/results/skin.vtp", jobs["items"][0]["id"].as_str().unwrap());
    let mut clients = Vec::new();
    until("no file can be opened", async || {
        clients.push(TcpStream::connect(server.host()).await.unwrap());
        is_shed(&ask(server.get(&skin)).await).then_some(())
    })
    .await;
    // Who is connected is answered.
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);
    ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    drop(clients);
    until("another is let in", async || {
        let stranger = reqwest::Client::new().get(format!("http://{}/healthz", server.host()));
        let answer = stranger.timeout(Duration::from_secs(1)).send().await.ok()?;
        (answer.status() == StatusCode::OK).then_some(())
    })
    .await;
    works_on(&server).await;
}

#[tokio::test]
async fn a_log_that_nobody_reads_holds_up_no_request() {
    let folder = TempDir::new().unwrap();
    let mut command = serve(folder.path());
    command.args(["--admin-bind", "127.0.0.1:0"]).stderr(Stdio::piped());
    let mut server = Server::start_command(command, folder);
    let metrics = server.second_line().strip_prefix("metrics on ").unwrap().to_owned();
    let log = server.standard_error();
    let asked = |id: &str| {
        let request = server.get("/healthz").header("x-request-id", id);
        ask(request.timeout(Duration::from_secs(10)))
    };
    // Each leaves a line of more than 100 bytes; a pipe takes 64 KiB.
    for _ in 0..1000 {
        asked("unread").await.expect(StatusCode::OK);
    }
    works_on(&server).await;
    let counted = String::from_utf8(ask(server.client.get(&metrics)).await.bytes).unwrap();
    let dropped =
        counted.lines().find_map(|line| line.strip_prefix("facies_log_lines_dropped_total "));
    assert!(dropped.unwrap().parse::<u32>().unwrap() > 100, "{dropped:?}");

    // Somebody reads again, until that is seen.
    let reader = std::thread::spawn(move || {
        let mut lines = BufReader::new(log).lines();
        lines.any(|line| line.unwrap().contains("read-again"))
    });
    until("a line is read again", async || {
        asked("read-again").await.expect(StatusCode::OK);
        reader.is_finished().then_some(())
    })
    .await;
    assert!(reader.join().unwrap());
    // The reader has gone for good.
    for _ in 0..10 {
        asked("lost").await.expect(StatusCode::OK);
    }
    works_on(&server).await;
}

/// Takes the last of a file, as much as a disk may have in its cache.
fn tear(file: &Path) {
    let length = std::fs::metadata(file).unwrap().len();
    let file = std::fs::OpenOptions::new().write(true).open(file).unwrap();
    file.set_len(length.saturating_sub(4096)).unwrap();
}

/// Where the bytes of a hash are.
fn blob(data: &Path, sha256: &str) -> PathBuf {
    let folder = std::fs::read_dir(data.join("blobs").join(&sha256[..2])).unwrap();
    let mut files = folder.map(|file| file.unwrap().path());
    files.find(|file| file.file_name().unwrap().to_str().unwrap().starts_with(sha256)).unwrap()
}

fn fsck(data: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.args(["admin", "fsck", "--data"]).arg(data).args(arguments).output().unwrap()
}

#[tokio::test]
async fn what_a_power_cut_tore_is_never_served_and_what_was_accepted_ends_once() {
    let server = faulty("solve:begin:1:hang:tag=slow", &["--workers", "1"]);
    let case = server.case(&SMALL).await;
    let done = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let running = accepted(&server, &tagged(&case, 2.0, "slow")).await;
    assert_eq!(server.started(&running).await["status"], "running");
    let queued = accepted(&server, &spec(&case, 3.0)).await;
    let folder = server.kill();

    tear(&folder.path().join("facies.db-wal"));
    let skin = &done["results"]["files"][0];
    let (name, sha256) = (skin["name"].as_str().unwrap(), skin["sha256"].as_str().unwrap());
    tear(&blob(folder.path(), sha256));
    let server = Server::start_in(folder, &["--workers", "1"]);
    assert_eq!(ask(server.get("/readyz")).await.status, StatusCode::OK);
    let damaged = format!("/v1/jobs/{}/results/{name}", done["id"].as_str().unwrap());
    ask(server.get(&damaged)).await.problem(500, "integrity");
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    let known = |id: &str| jobs["items"].as_array().unwrap().iter().any(|job| job["id"] == id);
    assert!(known(&running), "it was accepted before the last write");
    for (id, attempts) in [(running, 2), (queued, 1)] {
        if known(&id) {
            succeeds(&server, &id, attempts).await;
        }
    }
    let (folder, _) = server.terminate();

    let told = fsck(folder.path(), &["--read-all"]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert_eq!((told.status.code(), text.lines().count()), (Some(1), 1), "{text}");
    assert!(text.starts_with(&format!("lost or damaged: blob {sha256}")), "{text}");
    fsck(folder.path(), &["--read-all", "--repair"]);
    let server = Server::start_in(folder, &["--workers", "1"]);
    let id = done["id"].as_str().unwrap();
    assert_eq!(server.ended(id).await["status"], "successful");
    let skin = ask(server.get(&damaged)).await;
    assert_eq!(facies::schema::wire::canonical::sha256_hex(&skin.bytes), sha256);
    assert_eq!(state(&server, id).await["attempt"], 2);
}
